"""The specification of a value from outside, and its check."""

from __future__ import annotations

import math
import sys
from typing import TYPE_CHECKING, NamedTuple

from morse.core.reports.hints import closest
from morse.core.validation.arrays import array_check, list_check
from morse.core.validation.plain import check_plain, check_text

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy import ndarray

    from morse.core.values import Value

#: the largest finite number
LARGEST = sys.float_info.max
_INTEGER = 2**63

KINDS = ("number", "integer", "boolean", "string", "list", "dict", "any")


class Spec(NamedTuple):
    """The accepted values.

    Attributes:
        kind: ``number``, ``integer``, ``boolean``, ``string``, ``list``, ``dict`` or ``any``.
        shape: shape of a list or array of numbers, with None for an axis of any length; None for other values or any
            shape.
        least: minimum number of items of a list of numbers, if its shape is not declared.
        dtype: numpy dtype of the array into which a list is converted; empty if a list stays a list.
        low: smallest value of each item.
        high: largest value of each item.
        choices: the only allowed values.
        allow: special values that are accepted in spite of the range: ``inf``, ``-inf``, ``nan``, ``none``.
        unit: unit of the number, for messages.
        whole: whether integers are kept as integers.
    """

    kind: str = "any"
    shape: tuple[int | None, ...] | None = None
    least: int = 0
    dtype: str = ""
    low: float | None = None
    high: float | None = None
    choices: tuple[Value, ...] = ()
    allow: frozenset[str] = frozenset()
    unit: str = ""
    whole: bool = False

    def check(self) -> Callable[[Value], Value]:
        """Return a function that returns the value to be stored, or raises ValueError with the expected value."""
        check = _CHECKS[self.kind](self)
        if "none" not in self.allow:
            return check
        return lambda value: None if value is None else check(value)

    def range_text(self) -> str:
        """`` from 0 to 10 m``, `` from 0 upward``, or an empty string."""
        unit = f" {self.unit}" if self.unit else ""
        if self.low is not None and self.high is not None:
            return f" from {_brief(self.low)} to {_brief(self.high)}{unit}"
        if self.low is not None:
            return f" from {_brief(self.low)}{unit} upward"
        return "" if self.high is None else f" up to {_brief(self.high)}{unit}"

    def is_in_range(self, array: ndarray) -> bool:
        """Whether all numbers of an array are in the range, or special values that are accepted."""
        import numpy as np

        fine = np.isfinite(array)
        if self.low is not None:
            fine &= array >= self.low
        if self.high is not None:
            fine &= array <= self.high
        for name in self.allow - {"none"}:
            fine |= np.isnan(array) if name == "nan" else array == float(name)
        return bool(fine.all())


def _brief(limit: float) -> str:
    return str(limit) if isinstance(limit, int) else f"{limit:g}"


def _number(spec: Spec) -> Callable[[Value], Value]:
    low = -LARGEST if spec.low is None else spec.low
    high = LARGEST if spec.high is None else spec.high
    allow = spec.allow
    whole = spec.whole
    expectation = f"a number{spec.range_text()}"

    def check(value: Value) -> Value:
        number = value
        if type(value) is not float:
            number = real(value)
            if number is None:
                raise ValueError(expectation)
            if whole and isinstance(value, int):
                if not (low <= value <= high and -_INTEGER <= value < _INTEGER):
                    raise ValueError(expectation)
                return int(value)
        if low <= number <= high:  # not true of NaN
            return number
        if not math.isfinite(number):
            if str(float(number)) in allow:
                return number
            raise ValueError(expectation if math.isnan(number) else expectation.replace("a number", "a finite number"))
        raise ValueError(expectation)

    return check


def _integer(spec: Spec) -> Callable[[Value], Value]:
    low = -_INTEGER if spec.low is None else spec.low
    high = _INTEGER - 1 if spec.high is None else spec.high
    expectation = f"an integer{spec.range_text()}"

    def check(value: Value) -> int:
        number = real(value)
        # an integer is compared exactly, not as the nearest float
        if number is None or not math.isfinite(number) or number != math.floor(number) or not low <= int(value) <= high:
            raise ValueError(expectation)
        return int(value)

    return check


def real(value: Value) -> float | None:
    """Return a number as a float, infinite if it is too large; None if the value is not a number."""
    if isinstance(value, float):
        return float(value)
    if isinstance(value, bool):
        return None
    if isinstance(value, int):
        try:
            return float(value)
        except OverflowError:
            return math.inf if value > 0 else -math.inf
    # numpy scalars and zero-dimensional arrays
    if getattr(value, "shape", None) == () and getattr(value.dtype, "kind", "") in "iuf":
        return float(value)
    return None


def _boolean(spec: Spec) -> Callable[[Value], object]:
    def check(value: object) -> bool:
        if isinstance(value, bool) or (type(value) is int and value in (0, 1)) or type(value).__name__ == "bool_":
            return bool(value)
        raise ValueError("a boolean")

    return check


def _string(spec: Spec) -> Callable[[Value], object]:
    choices = spec.choices

    def check(value: object) -> str:
        if not isinstance(value, str):
            raise ValueError("a string" if not choices else _one_of(choices, value))
        check_text(value)
        if choices and value not in choices:
            raise ValueError(_one_of(choices, value))
        return value

    return check


def _one_of(choices: tuple[object, ...], value: object) -> str:
    near = closest(value, choices)
    return f"one of {', '.join(map(repr, choices))}" + (f"; did you mean {near!r}?" if near else "")


def _dictionary(spec: Spec) -> Callable[[Value], object]:
    def check(value: object) -> Value:
        if not isinstance(value, dict):
            raise ValueError("an object such as {...}")
        check_plain(value, spec.allow)
        return value

    return check


def _any(spec: Spec) -> Callable[[Value], object]:
    choices = spec.choices

    def check(value: object) -> Value:
        check_plain(value, spec.allow)
        if choices and value not in choices:
            raise ValueError(_one_of(choices, value))
        return value

    return check


def _list(spec: Spec) -> Callable[[Value], object]:
    item = _number(spec._replace(shape=None, allow=spec.allow - {"none"}))
    if spec.shape is not None:
        return array_check(spec.shape, spec.dtype, item, spec.is_in_range, spec.range_text())
    return list_check(spec.least, item, spec.allow, spec.range_text())


_CHECKS: dict[str, Callable[[Spec], Callable[[Value], Value]]] = {
    "number": _number,
    "integer": _integer,
    "boolean": _boolean,
    "string": _string,
    "list": _list,
    "dict": _dictionary,
    "any": _any,
}
