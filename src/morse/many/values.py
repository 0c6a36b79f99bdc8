"""Plain data, which files of results contain."""

from __future__ import annotations

from typing import Any, TypeAlias

import numpy as np

#: a row of results, or the facts of a study: numbers, texts and others by name, as functions of users return them
Row: TypeAlias = dict[str, Any]


def plain(value: object, what: str) -> Any:
    """Return a value as plain data: numbers, booleans, strings, None, and lists and dictionaries of them.

    Raises:
        TypeError: it is something else.
        ValueError: an integer has more than 64 bits, which neither tables nor statistics can contain; or it contains
            itself.
    """
    if isinstance(value, np.ndarray):
        value = value.tolist()
    elif isinstance(value, np.generic):
        value = value.item()
    if value is None or isinstance(value, (bool, str)):
        return value
    if isinstance(value, int):
        if not -(1 << 63) <= value < 1 << 64:
            raise ValueError(f"{what} is an integer of {value.bit_length()} bits; at most 64 are stored")
        return int(value)
    if isinstance(value, float):
        return float(value)
    try:
        if isinstance(value, (list, tuple)):
            return [plain(one, what) for one in value]
        if isinstance(value, dict):
            return {str(key): plain(one, what) for key, one in value.items()}
    except RecursionError:
        raise ValueError(f"{what} is nested too deeply, or contains itself") from None
    raise TypeError(
        f"{what} is a {type(value).__name__}, {value!r:.60}, expected a number, a string, a boolean, None, or a list "
        "of these"
    )
