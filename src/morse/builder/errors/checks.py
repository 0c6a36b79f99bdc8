"""Validation of arguments in scene scripts, with errors that name the argument and the correction."""

from __future__ import annotations

import logging
import math
from datetime import UTC, datetime
from numbers import Real
from types import ModuleType
from typing import TYPE_CHECKING, Any, NoReturn

from morse.builder import compatibility
from morse.core.reports.quoting import closest as closest
from morse.core.reports.quoting import nearest

if TYPE_CHECKING:
    from collections.abc import Iterable

logger = logging.getLogger(__name__)


def hint_at_radians(what: str, angles: Iterable[object]) -> None:
    """Warn about angles of more than a full turn, because they are most likely degrees.

    Args:
        what: name of the call in the message, e.g. ``Morsy.rotate``.
        angles: the arguments of the script; values that are not numbers are skipped.
    """
    for angle in angles:
        if (
            isinstance(angle, Real)
            and not isinstance(angle, bool)
            and 2.0 * math.pi + 1e-6 < abs(float(angle)) < math.inf
        ):
            logger.warning(
                "%s takes radians, and %g rad are %.3g turns; for degrees write math.radians(%g)",
                what,
                angle,
                angle / (2.0 * math.pi),
                angle,
            )
            return


def shown(value: object) -> str:
    """Return the shortened representation of a value for error messages."""
    text = repr(value)
    return text if len(text) <= 60 else text[:57] + "..."


def suggestion(word: str, candidates: Iterable[str], *, limit: int = 12) -> str:
    """``; did you mean 'x'?`` for a near miss, else ``; there are: a, b, c`` (at most ``limit`` names)."""
    return nearest(word, sorted(set(candidates)), say="there are", limit=limit)


def number(
    value: object,
    what: str,
    *,
    minimum: float | None = None,
    above: float | None = None,
    maximum: float | None = None,
    infinite: bool = False,
) -> float:
    """A finite number as a float.

    Args:
        value: the argument of the script; a text that contains a number is converted, with a warning.
        what: name of the argument in messages, e.g. ``set_gravity(gravity)``.
        minimum: smallest value allowed.
        above: exclusive lower bound.
        maximum: largest value allowed.
        infinite: allow infinities.

    Raises:
        TypeError: the value is not a number.
        ValueError: the value is NaN, infinite or out of range.
    """
    if type(value) is not float:
        value = compatibility.value_of_today("number", value, what)
    if isinstance(value, bool) or not isinstance(value, Real):
        raise TypeError(f"{what} takes a number, got {shown(value)}")
    # an integer of more bits is greater than all floats
    result = math.inf if isinstance(value, int) and value.bit_length() > 1000 else float(value)
    if math.isnan(result) or (math.isinf(result) and not infinite):
        raise ValueError(f"{what} takes a finite number, got {result}")
    if minimum is not None and result < minimum:
        raise ValueError(f"{what} takes a number of at least {minimum:g}, got {result:g}")
    if maximum is not None and result > maximum:
        raise ValueError(f"{what} takes a number of at most {maximum:g}, got {result:g}")
    if above is not None and result <= above:
        raise ValueError(f"{what} takes a number greater than {above:g}, got {result:g}")
    return result


def share(value: object, what: str) -> float:
    """A number from 0 to 1; see `number`."""
    result = number(value, what, minimum=0.0)
    if result > 1.0:
        raise ValueError(f"{what} takes a number from 0 to 1, got {result:g}")
    return result


def integer(value: object, what: str, *, minimum: int | None = None) -> int:
    """Return an integer (``2.0`` is accepted).

    Raises:
        TypeError: the value is not a number.
        ValueError: the value is not an integer, or is too small.
    """
    result = number(value, what, minimum=minimum)
    if result != int(result):
        raise ValueError(f"{what} takes an integer, got {result:g}")
    return int(result)


def triple(value: object, what: str) -> tuple[float, float, float]:
    """Three finite numbers, e.g. a position or a colour.

    Raises:
        TypeError: the value is not a sequence of numbers.
        ValueError: there are not three numbers, or one of them is not finite.
    """
    if isinstance(value, (str, bytes, dict)) or not hasattr(value, "__iter__"):
        raise TypeError(f"{what} takes three numbers such as [1.0, 0.0, 0.5], got {shown(value)}")
    items = list(value)
    if len(items) != 3:
        raise ValueError(f"{what} takes three numbers such as [1.0, 0.0, 0.5], got {len(items)}: {shown(items)}")
    x, y, z = (number(item, f"{what}, item {index},") for index, item in enumerate(items))
    return x, y, z


def color(value: object, what: str) -> tuple[float, float, float]:
    """Red, green and blue, each 0..1.

    Raises:
        TypeError: the value is not a sequence of numbers.
        ValueError: there are not three numbers, or one of them is out of range.
    """
    rgb = triple(value, what)
    if not all(0.0 <= channel <= 1.0 for channel in rgb):
        raise ValueError(f"{what} takes red, green and blue from 0 to 1, got {shown(rgb)}: divide 0..255 by 255")
    return rgb


def boolean(value: object, what: str) -> bool:
    """Return a boolean (1 and 0 are accepted; other numbers and texts with a warning).

    Raises:
        TypeError: the value is not a boolean.
    """
    value = compatibility.value_of_today("boolean", value, what)
    if isinstance(value, bool) or (isinstance(value, int) and value in (0, 1)):
        return bool(value)
    raise TypeError(f"{what} takes True or False, got {shown(value)}")


def text(value: object, what: str) -> str:
    """A non-empty string.

    Raises:
        TypeError: the value is not a string.
        ValueError: the string is empty.
    """
    if not isinstance(value, str):
        raise TypeError(f"{what} takes a string, got {shown(value)}")
    if not value:
        raise ValueError(f"{what} takes a non-empty string")
    return value


def date(value: object, what: str) -> float:
    """The seconds since the epoch of a date in ISO 8601 format, UTC unless it has another time zone.

    Raises:
        TypeError: the value is not a text.
        ValueError: the text is no date.
    """
    try:
        moment = datetime.fromisoformat(text(value, what))
    except ValueError:
        raise ValueError(f"{what} takes a date such as '2026-11-23' or '2026-11-23T12:00:00', got {value!r}") from None
    return (moment if moment.tzinfo else moment.replace(tzinfo=UTC)).timestamp()


def names(value: object, what: str) -> list[str]:
    """Several names; one name stands for a list of it, with a warning.

    Raises:
        TypeError: the value is not a list of strings.
    """
    result = compatibility.value_of_today("names", value, what)
    words = list(result) if hasattr(result, "__iter__") else [result]
    if not all(isinstance(word, str) for word in words):
        raise TypeError(f"{what} takes a list of names, got {shown(value)}")
    return words


def choice(value: object, options: Iterable[str], what: str) -> str:
    """One of several words.

    Raises:
        TypeError: the value is not a string.
        ValueError: the value is another word.
    """
    words = list(options)
    if text(value, what) in words:
        return str(value)
    near = closest(value, words)
    hint = f"; did you mean '{near}'?" if near else ""
    raise ValueError(f"{what} takes one of {', '.join(words)}; got '{value}'{hint}")


def missing_attribute(owner: object, name: str) -> Any:
    """An attribute of earlier versions that an object, or a module, does not have.

    Raises:
        AttributeError: it never existed; the message names the nearest one.
    """
    entries = () if name.startswith("__") else compatibility.installed()
    get = next((get for entry in entries if (get := entry.attribute(owner, name)) is not None), None)
    if get is None:
        unknown_attribute(owner, name)
    return get()


def set_missing_attribute(owner: object, name: str, value: object) -> None:
    """Set an attribute of earlier versions.

    Raises:
        AttributeError: it never existed; the message names the nearest one.
    """
    if not any(entry.set_attribute(owner, name, value) for entry in compatibility.installed()):
        unknown_attribute(owner, name)


def unknown_attribute(owner: object, name: str) -> NoReturn:
    """Raise the `AttributeError` for an attribute that does not exist; the message names the nearest one."""
    if isinstance(owner, ModuleType):
        kind, names = f"module '{owner.__name__}'", list(vars(owner))
    else:
        # classes with slots have no __dict__, and access to it would call this function again
        kind, names = type(owner).__name__, [*dir(type(owner)), *(vars(owner) if type(owner).__dictoffset__ else ())]
        if "__dir__" in vars(type(owner)):
            names += dir(owner)
    old = (word for entry in compatibility.installed() for word in entry.attributes(owner))
    near = closest(name, [word for word in (*names, *old) if not word.startswith("_")])
    hint = f"; did you mean '{near}'?" if near else ""
    # with a name, but without an object, Python adds no suggestion of its own
    raise AttributeError(f"{kind} has no attribute '{name}'{hint}", name=name)
