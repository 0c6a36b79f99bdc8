"""The specification of a value from outside, and its check."""

from __future__ import annotations

import math
import sys
from typing import TYPE_CHECKING, NamedTuple

from morse.core.exceptions import MorseError, MorseRPCTypeError
from morse.core.reports.quoting import closest

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy import ndarray

    from morse.core.values import Value


#: maximum nesting depth
DEEPEST = 32
_LOWEST_INTEGER, _HIGHEST_INTEGER = -(2**63), 2**64 - 1


def check_text(text: str) -> None:
    """Raise an error for strings that cannot be encoded as UTF-8: lone surrogates.

    Raises:
        ValueError: the message contains the expected value.
    """
    if not text.isascii():
        try:
            text.encode()
        except UnicodeEncodeError:
            raise ValueError("valid Unicode (no lone surrogates)") from None


def check_plain(value: object, allow: frozenset[str] = frozenset()) -> None:
    """Raise an error for values that some middleware cannot carry, at any depth.

    Objects that are neither strings, numbers, lists nor dictionaries come from the process itself and are not checked.

    Args:
        allow: special values that are accepted: ``inf``, ``-inf`` and ``nan``.

    Raises:
        ValueError: the message contains the expected value.
    """
    queue: list[tuple[object, int]] = [(value, 0)]
    while queue:
        item, depth = queue.pop()
        if isinstance(item, float):
            if not math.isfinite(item) and str(float(item)) not in allow:
                raise ValueError("finite numbers")
        elif isinstance(item, str):
            check_text(item)
        elif isinstance(item, int):
            if not _LOWEST_INTEGER <= item <= _HIGHEST_INTEGER:
                raise ValueError("integers of at most 64 bits")
        elif isinstance(item, (list, tuple, dict)):
            if depth >= DEEPEST:
                raise ValueError(f"lists and objects nested at most {DEEPEST} deep")
            if isinstance(item, dict):
                queue.extend((key, depth + 1) for key in item)
                item = item.values()
            queue.extend((inner, depth + 1) for inner in item)


def size_of(value: object) -> int:
    """Estimate the size of a value in bytes; strings and list items are counted, objects of other types are not."""
    size = 0
    queue = [value]
    while queue:
        item = queue.pop()
        size += 16
        if isinstance(item, (str, bytes)):
            size += len(item)
        elif isinstance(item, dict):
            queue.extend(item)
            queue.extend(item.values())
        elif isinstance(item, (list, tuple)):
            queue.extend(item)
    return size


def shape_text(shape: tuple[int | None, ...]) -> str:
    """``3 numbers``, ``N x 3 numbers``."""
    if shape == (1,):
        return "1 number"
    return " x ".join("N" if size is None else str(size) for size in shape) + " numbers"


def array_check(
    shape: tuple[int | None, ...],
    dtype: str,
    item: Callable[[object], object],
    in_range: Callable[[ndarray], bool],
    range_text: str,
) -> Callable[[object], object]:
    """Return a check for lists or arrays of exactly that shape.

    Args:
        dtype: numpy dtype of the array into which the value is converted; empty for a list.
        item: check of a single number.
        in_range: check of all numbers of an array.
        range_text: the range, for messages.
    """
    expectation = f"{'an array' if dtype else 'a list'} of {shape_text(shape)}{range_text}"

    def check(value: Value) -> Value:
        if hasattr(value, "dtype"):
            if not (_has_shape(value, shape) and in_range(value)):
                raise ValueError(expectation)
            return _as_array(value, shape, dtype, expectation) if dtype else value.tolist()
        if not isinstance(value, (list, tuple)):
            value = _listed(value, expectation)
        try:
            items = _nested(value, shape, item)
        except ValueError:
            raise ValueError(expectation) from None
        return _as_array(items, shape, dtype, expectation) if dtype else items

    return check


def _has_shape(array: ndarray, shape: tuple[int | None, ...]) -> bool:
    return (
        array.dtype.kind in "iuf"
        and array.ndim == len(shape)
        and all(length is None or length == size for length, size in zip(shape, array.shape, strict=True))
    )


def _listed(value: object, expectation: str) -> list[object]:
    # accepts mathutils vectors and tuples; strings are sequences as well, and are refused
    if isinstance(value, (str, bytes, dict)) or not hasattr(value, "__iter__"):
        raise ValueError(expectation)
    return list(value)


def _nested(value: object, shape: tuple[int | None, ...], item: Callable[[object], object]) -> list[Value]:
    if not isinstance(value, (list, tuple)):
        value = _listed(value, "")
    if shape[0] is not None and len(value) != shape[0]:
        raise ValueError
    if len(shape) == 1:
        return [item(number) for number in value]
    rows = [_nested(row, shape[1:], item) for row in value]
    if shape[1] is None and len({len(row) for row in rows}) > 1:
        raise ValueError
    return rows


def _as_array(value: list[object], shape: tuple[int | None, ...], dtype: str, expectation: str) -> object:
    import numpy as np

    if len(value) == 0:
        return np.zeros([size or 0 for size in shape], dtype)
    wide = np.array(value)
    try:
        with np.errstate(over="ignore"):
            array = np.array(wide, dtype)
    except OverflowError:
        raise ValueError(f"{expectation} that fit {dtype}") from None
    if array.dtype.kind in "iu" and not (array == wide).all():
        raise ValueError(f"{expectation} that fit {dtype}")
    return array


def list_check(
    least: int, item: Callable[[object], object], allow: frozenset[str], range_text: str
) -> Callable[[object], list[object]]:
    """Return a check for lists without declared shape: at least ``least`` numbers, or any items if it is 0."""
    expectation = f"a list of {least} numbers" if least > 1 else "a list of numbers" if least else "a list"

    def check(value: object) -> list[Value]:
        if hasattr(value, "tolist"):
            value = value.tolist()
        if not isinstance(value, (list, tuple)) or (least > 1 and len(value) < least):
            raise ValueError(expectation + range_text)
        if not least:
            check_plain(value, allow)
            return value if isinstance(value, list) else list(value)
        try:
            return [item(number) for number in value]
        except ValueError:
            raise ValueError(expectation + range_text) from None

    return check


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


def _boolean(spec: Spec) -> Callable[[object], object]:
    def check(value: object) -> bool:
        if isinstance(value, bool) or (type(value) is int and value in (0, 1)) or type(value).__name__ == "bool_":
            return bool(value)
        raise ValueError("a boolean")

    return check


def _string(spec: Spec) -> Callable[[object], object]:
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


def _dictionary(spec: Spec) -> Callable[[object], object]:
    def check(value: object) -> Value:
        if not isinstance(value, dict):
            raise ValueError("an object such as {...}")
        check_plain(value, spec.allow)
        return value

    return check


def _any(spec: Spec) -> Callable[[object], object]:
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


class CommandError(MorseError, ValueError):
    """A message is not valid for a component.

    Attributes:
        field: name of the invalid field, shortened and escaped, or an empty string.
    """

    def __init__(self, field: str, message: str) -> None:
        super().__init__(message)
        self.field = field


class PropertyError(MorseRPCTypeError, ValueError, TypeError):
    """A property does not exist, or its value is not valid."""


class OptionError(MorseError, ValueError):
    """An option of a modifier or a stream does not exist, or its value is not valid."""
