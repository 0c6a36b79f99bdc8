"""Checks of values that come from outside against what a component declares."""

from __future__ import annotations

import contextlib
import difflib
import math
from typing import TYPE_CHECKING, Any

from morse.core.declarations import properties
from morse.core.exceptions import MorseRPCTypeError

if TYPE_CHECKING:
    from morse.core.object import Object


def nearest(word: str, known: list[str]) -> str:
    """``; did you mean 'x'?`` if there is a name close to ``word``, else the list of names."""
    close = difflib.get_close_matches(word, known, n=1)
    if close:
        return f"; did you mean '{close[0]}'?"
    return f"; known: {', '.join(known)}" if known else ""


def numbers(values: Any, count: int) -> list[float]:
    """A list of that many finite numbers.

    Raises:
        MorseRPCTypeError: it is something else.
    """
    if isinstance(values, list) and len(values) == count and all(type(v) in (int, float) for v in values):
        # integers may be too large
        with contextlib.suppress(OverflowError):
            floats = [float(v) for v in values]
            if all(map(math.isfinite, floats)):
                return floats
    raise MorseRPCTypeError(f"expected {count} number{'s' if count > 1 else ''}, not {values!r}")


def same_kind(default: Any, value: Any) -> bool:
    """Whether ``value`` can stand where ``default`` stood."""
    if default is None:
        return True
    if isinstance(default, bool):
        return isinstance(value, bool) or (type(value) is int and value in (0, 1))
    if isinstance(default, (int, float)):
        return isinstance(value, (int, float)) and not isinstance(value, bool) and not math.isnan(value)
    if isinstance(default, str):
        return isinstance(value, str)
    if isinstance(default, (list, tuple)):
        return isinstance(value, (list, tuple))
    if isinstance(default, dict):
        return isinstance(value, dict)
    return True


def checked_property(component: Object, name: str, value: Any) -> tuple[str, Any]:
    """The Python name of a property and the value to store.

    Raises:
        MorseRPCTypeError: no such property, or a value of the wrong type.
    """
    declared = properties(type(component))
    by_name = {prop.name: (python_name, prop) for python_name, prop in declared.items()}
    if name not in by_name:
        raise MorseRPCTypeError(f"{component.name()} has no property '{name}'{nearest(name, sorted(by_name))}")
    python_name, prop = by_name[name]
    if not same_kind(prop.default, value):
        expected = prop.type or type(prop.default).__name__
        raise MorseRPCTypeError(f"property '{name}' of {component.name()} takes a {expected}, not {value!r}")
    if isinstance(prop.default, bool):
        value = bool(value)
    elif isinstance(prop.default, float):
        value = float(value)
    return python_name, value
