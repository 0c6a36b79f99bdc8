"""Data as standard JSON: NaN and infinity are ``null``."""

from __future__ import annotations

import msgspec

from morse.core.streams.extent import listed


def _plain(value: object) -> object:
    if hasattr(value, "tolist"):  # numpy
        return listed(value)
    if isinstance(value, (set, frozenset)):
        return sorted(value, key=str)  # the order of a set differs between processes
    if hasattr(value, "__iter__"):  # vectors and matrices
        return list(value)
    return str(value)


_ENCODER = msgspec.json.Encoder(enc_hook=_plain)


def as_json(value: object) -> str:
    """A value as JSON.

    Raises:
        ValueError, TypeError, RecursionError: it has no JSON representation.
    """
    return _ENCODER.encode(value).decode()


def from_json(text: str) -> object:
    """Parse JSON of a client.

    Raises:
        ValueError: the text is not JSON.
    """
    try:
        return msgspec.json.decode(text)
    except (msgspec.DecodeError, RecursionError) as error:
        raise ValueError(f"not JSON ({error})") from None
