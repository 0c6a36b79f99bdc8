"""Rows of a batch, and the values that belong to them."""

from __future__ import annotations

import numbers
import os
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray


def rows_of(rows: object, count: int) -> list[int]:
    """Return row numbers.

    Args:
        rows: None for all rows, a number, a slice, a list of numbers, or an array of ``count`` booleans.
        count: number of rows of the batch.

    Raises:
        IndexError: there is no such row.
        ValueError: a row is given twice.
        TypeError: it is not any of these.
    """
    if rows is None:
        return list(range(count))
    if isinstance(rows, slice):
        return list(range(count))[rows]
    try:
        array = np.asarray(rows)
    except ValueError:  # lists of different lengths
        array = np.empty((1, 1))
    if array.dtype == bool:
        if array.shape != (count,):
            raise IndexError(f"a mask of rows has the shape ({count},), not {array.shape}")
        return [int(row) for row in np.flatnonzero(array)]
    if array.size == 0:
        return []
    if array.dtype.kind not in "iu" or array.ndim > 1:
        raise TypeError(f"rows are a number, a list of numbers, a slice or a mask, not {rows!r:.80}")
    numbers = [int(row) for row in np.atleast_1d(array)]
    for row in numbers:
        if not -count <= row < count:
            raise IndexError(f"there is no row {row}: the batch has {count} rows, from 0 to {count - 1}")
    numbers = [row % count for row in numbers]
    if len(set(numbers)) != len(numbers):
        raise ValueError(f"a row is given twice: {numbers!r:.80}")
    return numbers


def only_row_of(row: object, count: int) -> int:
    """Return the number of one row.

    Raises:
        IndexError: there is no such row.
        TypeError: it is not a number.
    """
    if isinstance(row, bool) or not isinstance(row, numbers.Integral):
        raise TypeError(f"a row is an integer, not {row!r:.80}")
    return rows_of(row, count)[0]


def seeds_of(seeds: Any, rows: Sequence[int]) -> list[int]:
    """Return one seed for each row; a number ``s`` stands for the seeds ``s + row``.

    Raises:
        ValueError: there is another number of seeds than rows.
        TypeError: a seed is not an integer.
    """
    if isinstance(seeds, numbers.Integral) and not isinstance(seeds, bool):
        return [int(seeds) + row for row in rows]
    try:
        values = list(seeds)
    except TypeError:
        raise TypeError(f"seed is an integer, or a list of one integer for each row, not {seeds!r:.80}") from None
    if len(values) != len(rows):
        raise ValueError(f"there are {len(rows)} rows, but {len(values)} seeds")
    for value in values:
        if isinstance(value, bool) or not isinstance(value, numbers.Integral):
            raise TypeError(f"a seed is an integer, not {value!r:.80}")
    return [int(value) for value in values]


def values_of(values: object, rows: Sequence[int], what: str) -> list[float]:
    """Return one number for each row; a number stands for all rows.

    Raises:
        ValueError: there is another number of values than rows.
    """
    array = _floats(values, what)
    if array.ndim == 0:
        return [float(array)] * len(rows)
    if array.shape != (len(rows),):
        raise ValueError(f"{what} has the shape {array.shape}, expected one number or ({len(rows)},)")
    return [float(value) for value in array]


def names_of(names: object, rows: Sequence[int]) -> list[str]:
    """Return one path for each row; a single path stands for all rows.

    Raises:
        ValueError: there is another number of paths than rows.
    """
    if isinstance(names, (str, os.PathLike)):
        return [os.fspath(names)] * len(rows)
    if not isinstance(names, Sequence) or len(names) != len(rows):
        raise ValueError(f"expected one path of a picture, or one for each of {len(rows)} rows, not {names!r:.100}")
    return [os.fspath(name) for name in names]


def vectors_of(values: object, rows: Sequence[int], what: str) -> NDArray[np.float64]:
    """Return (M, K) one vector for each row; a single vector stands for all rows.

    Raises:
        ValueError: another shape.
    """
    array = _floats(values, what)
    if array.ndim == 1:
        array = np.broadcast_to(array, (len(rows), len(array)))
    if array.ndim != 2 or len(array) != len(rows):
        raise ValueError(
            f"{what} have the shape {array.shape}, expected one vector, or one for each of {len(rows)} rows"
        )
    return array


def _floats(values: object, what: str) -> NDArray[np.float64]:
    try:
        return np.asarray(values, np.float64)
    except (TypeError, ValueError, OverflowError):
        raise ValueError(f"{what}: {values!r:.80} is no array of numbers") from None
