"""Data as JSON that every reader understands: what is not finite is ``null``."""

from __future__ import annotations

from typing import Any

import msgspec


def _plain(value: Any) -> Any:
    if hasattr(value, "tolist"):  # numpy
        return value.tolist()
    if isinstance(value, (set, frozenset)):
        return sorted(value, key=str)  # the order of a set differs from process to process
    if hasattr(value, "__iter__"):  # vectors and matrices
        return list(value)
    return str(value)


_ENCODER = msgspec.json.Encoder(enc_hook=_plain)


def as_json(value: Any) -> str:
    """A value as JSON.

    Raises:
        ValueError, TypeError, RecursionError: it has no form in JSON.
    """
    return _ENCODER.encode(value).decode()


def from_json(text: str) -> Any:
    """What a client has sent.

    Raises:
        ValueError: the text is not JSON.
    """
    try:
        return msgspec.json.decode(text)
    except (msgspec.DecodeError, RecursionError) as error:
        raise ValueError(f"no JSON ({error})") from None
