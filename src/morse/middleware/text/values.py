"""Values in Python notation."""

from __future__ import annotations

from typing import Any

from morse.core.streams.extent import listed


def written(value: object) -> str:
    """The value on one line; arrays as lists, a set in a fixed order."""
    return repr(_plain(value)).replace("\n", " ")


def _plain(value: Any) -> Any:
    if hasattr(value, "tolist"):  # numpy
        return listed(value)
    if isinstance(value, dict):
        return {name: _plain(inner) for name, inner in value.items()}
    if type(value) in (list, tuple):
        return type(value)(_plain(inner) for inner in value)
    if isinstance(value, (set, frozenset)):
        return sorted(value, key=str)  # the order of a set differs between processes
    return value
