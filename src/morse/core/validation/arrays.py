"""Checks of lists and arrays of numbers."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.core.validation.plain import check_plain

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy import ndarray

    from morse.core.values import Value


def shape_text(shape: tuple[int | None, ...]) -> str:
    """``3 numbers``, ``N x 3 numbers``."""
    if shape == (1,):
        return "1 number"
    return " x ".join("N" if size is None else str(size) for size in shape) + " numbers"


def array_check(
    shape: tuple[int | None, ...],
    dtype: str,
    item: Callable[[Value], object],
    in_range: Callable[[ndarray], bool],
    range_text: str,
) -> Callable[[Value], object]:
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


def _nested(value: object, shape: tuple[int | None, ...], item: Callable[[Value], object]) -> list[Value]:
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
    least: int, item: Callable[[Value], object], allow: frozenset[str], range_text: str
) -> Callable[[Value], list[object]]:
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
