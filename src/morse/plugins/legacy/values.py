"""Arguments in the forms of MORSE 1.4: texts for numbers, one name for a list, scalars and arrays of numpy."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from morse.builder.workspace import notice

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from morse.core.values import Value


def scalar(value: Value) -> object:
    """The Python scalar of a scalar of numpy, or of an array of one element; anything else unchanged."""
    if getattr(value, "size", None) == 1 and callable(getattr(value, "item", None)):
        return value.item()
    return value


def quoted(text: str, new: str) -> tuple[str, str]:
    """The change of a text in the script, in either kind of quotes, into something else."""
    return (f"'{text}'|\"{text}\"", new)


def number(value: object, what: str) -> Value:
    """The number that a text contains; anything else unchanged."""
    value = scalar(value)
    if not isinstance(value, str):
        return value
    try:
        result = float(value)
    except ValueError:
        return value
    if not math.isfinite(result):
        return value
    notice(f"{what} takes a number, got the text {value!r}; write {result:g}", *quoted(value, f"{result:g}"))
    return result


def boolean(value: object, what: str) -> object:
    """The truth value of a number or a text: any text that is not empty is true; anything else unchanged."""
    value = scalar(value)
    if not isinstance(value, (str, int, float)) or value in (True, False):
        return bool(value) if isinstance(value, float) else value
    truth = str(bool(value))
    edit = quoted(value, truth) if isinstance(value, str) else (str(value), truth)
    notice(f"{what} takes True or False, got {value!r}, which counts as {truth}; write {truth}", *edit)
    return bool(value)


def names(value: object, what: str) -> Value:
    """A list of the one name that a text is; anything else unchanged."""
    if not isinstance(value, str):
        return value
    notice(f"{what} takes a list of names, got {value!r}; write [{value!r}]", *quoted(value, f"[{value!r}]"))
    return [value]


#: the functions by what is expected
VALUES: Mapping[str, Callable[[object, str], object]] = {"number": number, "boolean": boolean, "names": names}
