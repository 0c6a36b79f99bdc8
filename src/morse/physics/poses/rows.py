"""Rows of an array as tuples of floats, converted on demand."""

from __future__ import annotations

from struct import Struct
from typing import TYPE_CHECKING, overload

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray


#: maximum size of a block of arrays, bytes: so much stays in the cache of a processor
_BLOCK = 1 << 16
#: maximum and minimum number of arrays in a block
_MOST, _LEAST = 64, 4


class Rows:
    """The rows of an array for scalar code.

    After `share`, the caller owns the array; the rows are copied before the next write. Arrays for `take` are made in
    advance, many at once: creating one takes several times as long as filling it.

    Args:
        array: (N, D).
        taken: number of the first rows that `take` replaces.

    Attributes:
        array: all rows (N, D); the array must be read immediately and not be modified.
        place: the address of the array; 0 if it is not known, because it takes a while to find out.
    """

    __slots__ = ("_first", "_is_shared", "_made", "_none", "_row", "_rows", "_size", "array", "place")

    def __init__(self, array: NDArray[np.float64], count: int = 0) -> None:
        self.array = array
        self._first = array[:count]
        self._is_shared = False
        self._row = Struct(f"={array.shape[1]}d")
        self._size = self._row.size
        self._rows: list[Sequence[float] | None] = [None] * len(array)
        self._none: list[Sequence[float] | None] = [None] * count
        #: copies of the array, the first rows of each, and its address
        self._made: list[tuple[NDArray[np.float64], NDArray[np.float64], int]] = []
        self.place = 0

    def take(self, values: NDArray[np.float64], rows: NDArray[np.intp] | None = None) -> None:
        """Set new values for the first rows.

        Args:
            values: (M, D).
            rows: the rows of ``values`` to take; None for all.
        """
        if self._is_shared:
            self._is_shared = False
            view = self._made
            if not view:
                view += self._copies()
            if view:
                self.array, self._first, self.place = view.pop()
            else:
                self.place = 0
                self.array = self.array.copy()
                self._first = self.array[: len(self._none)]
        if rows is None:
            self._first[...] = values
        else:
            values.take(rows, 0, self._first, "clip")
        self._rows[: len(self._none)] = self._none

    def _copies(self) -> list[tuple[NDArray[np.float64], NDArray[np.float64], int]]:
        """Return copies for the next calls of `take`; none of a large array."""
        array, count = self.array, len(self._none)
        number = min(_MOST, _BLOCK // max(array.nbytes, 1))
        if number < _LEAST:
            return []
        block = np.empty((number, *array.shape))
        block[:, count:] = array[count:]
        begin = block.ctypes.data
        places = range(begin, begin + block.nbytes, array.nbytes)
        return list(zip(block, block[:, :count], places, strict=True))[::-1]

    def _own(self) -> None:
        if self._is_shared:
            self.array = self.array.copy()
            self._first = self.array[: len(self._none)]
            self._is_shared, self.place = False, 0

    def share(self) -> NDArray[np.float64]:
        """Return all present rows (N, D); the array does not change afterwards."""
        self._is_shared = True
        return self.array

    def __len__(self) -> int:
        return len(self._rows)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Rows) and np.array_equal(self.array, other.array, equal_nan=True)

    __hash__ = None  # type: ignore[assignment]

    @overload
    def __getitem__(self, index: int) -> Sequence[float]: ...

    @overload
    def __getitem__(self, index: slice) -> list[Sequence[float]]: ...

    def __getitem__(self, index: int | slice) -> Sequence[float] | list[Sequence[float]]:
        if isinstance(index, slice):
            return [self[i] for i in range(*index.indices(len(self)))]
        row = self._rows[index]
        if row is None:
            # takes a third of the time of reading from the array
            row = self._rows[index] = self._row.unpack_from(self.array, self._size * index)  # type: ignore[arg-type]
        return row

    def __setitem__(self, index: int, values: Sequence[float]) -> None:
        self._own()
        self._made.clear()
        self.array[index] = values
        self._rows[index] = values
