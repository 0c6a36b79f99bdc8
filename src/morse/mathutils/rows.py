"""Matrix algebra on lists of two to four rows."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, MutableSequence, Sequence
from operator import mul
from typing import Any, TypeAlias

Rows: TypeAlias = list[list[float]]


def identity(size: int) -> Rows:
    """Return ones on the diagonal."""
    return [[1.0 if i == j else 0.0 for j in range(size)] for i in range(size)]


def product(a: Sequence[Sequence[float]], b: Sequence[Sequence[float]]) -> Rows:
    """Return the matrix product of a and b."""
    columns = list(zip(*b, strict=True))
    if len(b) == 4:
        return [[p * s + q * t + r * u + o * v for s, t, u, v in columns] for p, q, r, o in a]
    return [[sum(map(mul, row, column)) for column in columns] for row in a]


def transposed(a: Sequence[Sequence[float]]) -> Rows:
    """Return the transposed matrix."""
    return [list(column) for column in zip(*a, strict=True)]


def minor(a: Sequence[Sequence[float]], row: int, column: int) -> Rows:
    """Return the matrix without one row and one column."""
    return [[*line[:column], *line[column + 1 :]] for i, line in enumerate(a) if i != row]


def determinant(a: Sequence[Sequence[float]]) -> float:
    """Return the determinant of a square matrix, by expansion along the first row."""
    if len(a) == 2:
        return a[0][0] * a[1][1] - a[0][1] * a[1][0]
    if len(a) == 3:
        (p, q, r), (s, t, u), (v, w, x) = a
        return p * (t * x - u * w) - q * (s * x - u * v) + r * (s * w - t * v)
    return sum((-1.0) ** j * a[0][j] * determinant(minor(a, 0, j)) for j in range(len(a)))


def inverted(a: Sequence[Sequence[float]]) -> Rows | None:
    """Return the inverse by Gauss-Jordan elimination with partial pivoting, or None for a singular matrix."""
    size = len(a)
    work = [[*row, *unit] for row, unit in zip(a, identity(size), strict=True)]
    largest = max(abs(value) for row in a for value in row)
    for column in range(size):
        pivot = max(range(column, size), key=lambda i: abs(work[i][column]))
        if not abs(work[pivot][column]) > 1e-15 * largest:
            return None
        work[column], work[pivot] = work[pivot], work[column]
        lead = work[column][column]
        work[column] = [value / lead for value in work[column]]
        for i in range(size):
            factor = work[i][column]
            if i != column and factor != 0.0:
                work[i] = [value - factor * base for value, base in zip(work[i], work[column], strict=True)]
    return [row[size:] for row in work]


class Column(MutableSequence[float]):
    """One column of a matrix, or its upper part; assigning to its items changes the matrix."""

    __slots__ = ("_column", "_rows")

    def __init__(self, rows: Rows, column: int, height: int) -> None:
        self._rows = rows[:height]
        self._column = column

    def __len__(self) -> int:
        return len(self._rows)

    def __iter__(self) -> Iterator[float]:
        return iter([row[self._column] for row in self._rows])

    def __getitem__(self, index: Any) -> Any:
        if isinstance(index, slice):
            return [row[self._column] for row in self._rows[index]]
        return self._rows[index][self._column]

    def __setitem__(self, index: Any, value: Any) -> None:
        if isinstance(index, slice):
            for row, item in zip(self._rows[index], value, strict=True):
                row[self._column] = item
        else:
            self._rows[index][self._column] = value

    def __delitem__(self, index: object) -> None:
        raise TypeError("a column of a matrix has a fixed length")

    def insert(self, index: int, value: float) -> None:
        """Raise an error, because the length is fixed."""
        raise TypeError("a column of a matrix has a fixed length")


class Lines:
    """The rows or the columns of a matrix as vectors; assigning to their items changes the matrix."""

    __slots__ = ("_count", "_line")

    def __init__(self, line: Callable[[int], Any], count: int) -> None:
        self._line = line
        self._count = count

    def __len__(self) -> int:
        return self._count

    def __getitem__(self, index: int) -> object:
        return self._line(self._checked(index))

    def __setitem__(self, index: int, values: Iterable[float]) -> None:
        self._line(self._checked(index))[:] = values

    def __iter__(self) -> Iterator[Any]:
        return (self._line(index) for index in range(self._count))

    def _checked(self, index: int) -> int:
        if not -self._count <= index < self._count:
            raise IndexError(f"the matrix has {self._count} of them, given the index {index}")
        return index % self._count
