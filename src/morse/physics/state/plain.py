"""Plain data: the values that a saved state may contain."""

from __future__ import annotations

import numpy as np

_SINGLE = (type(None), bool, int, float, str, bytes)


class NotPlainError(ValueError):
    """A saved state cannot contain values of this type; the message names the type."""


def plain_copy(value: object) -> object:
    """Return a copy that shares no mutable objects with the original.

    Raises:
        NotPlainError: the value contains an object other than None, booleans, numbers, strings, bytes, arrays of
            numbers, and lists, tuples and dictionaries with string keys of these.
    """
    if type(value) in _SINGLE:
        return value
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, np.ndarray) and value.dtype.kind in "biuf":
        return value.copy()
    if isinstance(value, (list, tuple)):
        items = [plain_copy(item) for item in value]
        return items if isinstance(value, list) else tuple(items)
    if isinstance(value, dict) and all(isinstance(key, str) for key in value):
        return {key: plain_copy(item) for key, item in value.items()}
    raise NotPlainError(type(value).__name__)
