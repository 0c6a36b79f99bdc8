"""Matrices with two to four rows and columns."""

from __future__ import annotations

import collections.abc
from collections.abc import Callable, Iterable, Iterator, MutableSequence, Sequence
from math import cos, sin
from operator import mul
from typing import TYPE_CHECKING, Any, Self, SupportsFloat, TypeAlias, overload

from morse.mathutils import rotations
from morse.mathutils.orientation import Euler, Quaternion, Vector
from morse.mathutils.sequence import floats, is_number, rounded

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Sequence


Rows: TypeAlias = list[list[float]]


def identity_rows(size: int) -> Rows:
    """Return ones on the diagonal."""
    return [[1.0 if i == j else 0.0 for j in range(size)] for i in range(size)]


def product_rows(a: Sequence[Sequence[float]], b: Sequence[Sequence[float]]) -> Rows:
    """Return the matrix product of a and b."""
    columns = list(zip(*b, strict=True))
    if len(b) == 4:
        return [[p * s + q * t + r * u + o * v for s, t, u, v in columns] for p, q, r, o in a]
    return [[sum(map(mul, row, column)) for column in columns] for row in a]


def transposed_rows(a: Sequence[Sequence[float]]) -> Rows:
    """Return the transposed matrix."""
    return [list(column) for column in zip(*a, strict=True)]


def minor_rows(a: Sequence[Sequence[float]], row: int, column: int) -> Rows:
    """Return the matrix without one row and one column."""
    return [[*line[:column], *line[column + 1 :]] for i, line in enumerate(a) if i != row]


def determinant_of_rows(a: Sequence[Sequence[float]]) -> float:
    """Return the determinant of a square matrix, by expansion along the first row."""
    if len(a) == 2:
        return a[0][0] * a[1][1] - a[0][1] * a[1][0]
    if len(a) == 3:
        (p, q, r), (s, t, u), (v, w, x) = a
        return p * (t * x - u * w) - q * (s * x - u * v) + r * (s * w - t * v)
    return sum((-1.0) ** j * a[0][j] * determinant_of_rows(minor_rows(a, 0, j)) for j in range(len(a)))


def inverted_rows(a: Sequence[Sequence[float]]) -> Rows | None:
    """Return the inverse by Gauss-Jordan elimination with partial pivoting, or None for a singular matrix."""
    size = len(a)
    work = [[*row, *unit] for row, unit in zip(a, identity_rows(size), strict=True)]
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


_IDENTITY = ((1.0, 0.0, 0.0, 0.0), (0.0, 1.0, 0.0, 0.0), (0.0, 0.0, 1.0, 0.0), (0.0, 0.0, 0.0, 1.0))


class Matrix:
    """A matrix of floats; ``Matrix()`` is the 4x4 identity.

    ``m[i]`` is row `i` as a vector; assigning to its items changes the matrix. ``a * b`` and ``a @ b`` are the matrix
    product; a 4x4 matrix rotates and translates a 3-vector. The translation of a pose is in the last column.
    """

    __slots__ = ("_rows",)
    _rows: Rows

    def __init__(self, rows: Iterable[Iterable[SupportsFloat]] = _IDENTITY) -> None:
        try:
            self._rows = [floats(row, "a row of a Matrix", 2, 4) for row in rows]
        except TypeError as error:
            raise TypeError(f"Matrix takes 2 to 4 rows of 2 to 4 numbers, given {rows!r}") from error
        widths = {len(row) for row in self._rows}
        if not 2 <= len(self._rows) <= 4 or len(widths) != 1:
            raise ValueError(
                f"Matrix takes 2 to 4 rows of equal length, given {len(self._rows)} rows of lengths "
                f"{[len(row) for row in self._rows]}"
            )

    @classmethod
    def _wrap(cls, rows: Rows) -> Self:
        """Create a matrix from these rows, which are neither copied nor checked."""
        matrix = cls.__new__(cls)
        matrix._rows = rows
        return matrix

    # constructors --------------------------------------------------------------------------------

    @classmethod
    def Identity(cls, size: int) -> Self:  # noqa: N802 (Blender's name, as those below)
        """Return the identity with 2 to 4 rows."""
        return cls(identity_rows(size))

    @classmethod
    def Diagonal(cls, values: Iterable[float]) -> Self:  # noqa: N802
        """Return a matrix with the given diagonal and zeros elsewhere."""
        row = floats(values, "Matrix.Diagonal", 2, 4)
        return cls._wrap([[value if i == j else 0.0 for j in range(len(row))] for i, value in enumerate(row)])

    @classmethod
    def Rotation(cls, angle: float, size: int, axis: str | Iterable[float] | None = None) -> Self:  # noqa: N802
        """Return a rotation by an angle.

        Args:
            angle: radians, counter-clockwise looking against the axis.
            size: number of rows: 2, 3 or 4.
            axis: ``X``, ``Y``, ``Z`` or a vector; not used for size 2.
        """
        if size == 2:
            return cls._wrap([[cos(angle), -sin(angle)], [sin(angle), cos(angle)]])
        if size not in (3, 4):
            raise ValueError(f"Matrix.Rotation: the size is 2, 3 or 4, given {size!r}")
        if axis is None:
            raise ValueError("Matrix.Rotation: a 3x3 or 4x4 rotation needs an axis: 'X', 'Y', 'Z' or a vector")
        if isinstance(axis, str):
            if axis not in ("X", "Y", "Z"):
                raise ValueError(f"Matrix.Rotation: the axis is 'X', 'Y', 'Z' or a vector, given {axis!r}")
            axis = [1.0 if letter == axis else 0.0 for letter in "XYZ"]
        three = Quaternion(axis, angle).to_matrix()
        return cls._wrap(three._rows if size == 3 else three.to_4x4()._rows)

    @classmethod
    def Translation(cls, vector: Iterable[float]) -> Self:  # noqa: N802
        """Return a 4x4 matrix that translates by a 3-vector."""
        matrix = cls()
        matrix.translation = vector
        return matrix

    @classmethod
    def Scale(cls, factor: float, size: int, axis: Iterable[float] | None = None) -> Self:  # noqa: N802
        """Return a scaling by a factor, in all directions or only along an axis."""
        matrix = cls.Identity(size)
        count = 2 if size == 2 else 3
        direction = None if axis is None else Vector(axis).resized(count).normalized()
        for i in range(count):
            if direction is None:
                matrix._rows[i][i] = float(factor)
                continue
            for j in range(count):
                matrix._rows[i][j] += (factor - 1.0) * direction[i] * direction[j]
        return matrix

    @classmethod
    def LocRotScale(  # noqa: N802
        cls,
        location: Iterable[float] | None,
        rotation: Euler | Quaternion | Matrix | None,
        scale: Iterable[float] | None,
    ) -> Self:
        """Return a 4x4 matrix that scales, then rotates, then translates; None omits a part."""
        linear = identity_rows(3) if rotation is None else rotations.rows_of(rotation.as_rotation())
        factors = (1.0, 1.0, 1.0) if scale is None else floats(scale, "Matrix.LocRotScale scale", 3, 3)
        offset = (0.0, 0.0, 0.0) if location is None else floats(location, "Matrix.LocRotScale location", 3, 3)
        rows = [
            [*(a * s for a, s in zip(row, factors, strict=True)), translation]
            for row, translation in zip(linear, offset, strict=True)
        ]
        return cls._wrap([*rows, [0.0, 0.0, 0.0, 1.0]])

    # rows and columns ----------------------------------------------------------------------------

    def __len__(self) -> int:
        return len(self._rows)

    def __iter__(self) -> Iterator[Vector]:
        return (Vector._wrap(row) for row in self._rows)

    @overload
    def __getitem__(self, index: int) -> Vector: ...
    @overload
    def __getitem__(self, index: slice) -> tuple[Vector, ...]: ...
    def __getitem__(self, index: Any) -> Any:
        if isinstance(index, slice):
            return tuple(Vector._wrap(row) for row in self._rows[index])
        return Vector._wrap(self._rows[index])

    def __setitem__(self, index: int, values: Iterable[float]) -> None:
        width = len(self._rows[0])
        self._rows[index][:] = floats(values, "a row of this Matrix", width, width)

    @property
    def row(self) -> Lines:
        """The rows as vectors; assigning to their items changes the matrix."""
        return Lines(lambda index: Vector._wrap(self._rows[index]), len(self._rows))

    @property
    def col(self) -> Lines:
        """The columns as vectors; assigning to their items changes the matrix."""
        return Lines(lambda index: Vector._wrap(Column(self._rows, index, len(self._rows))), len(self._rows[0]))

    @property
    def translation(self) -> Vector:
        """The first three items of the last column of a 4x4 or 3x4 matrix; assigning to them changes the matrix."""
        if len(self._rows[0]) != 4 or len(self._rows) < 3:
            raise AttributeError(f"a {self._shape()} Matrix has no translation: convert it with to_4x4() first")
        return Vector._wrap(Column(self._rows, 3, 3))

    @translation.setter
    def translation(self, vector: Iterable[float]) -> None:
        self.translation[:] = vector

    def _shape(self) -> str:
        return f"{len(self._rows)}x{len(self._rows[0])}"

    # arithmetic ----------------------------------------------------------------------------------

    @overload
    def __mul__(self, other: Matrix | float) -> Matrix: ...
    @overload
    def __mul__(self, other: Vector) -> Vector: ...
    def __mul__(self, other: Any) -> Any:
        if isinstance(other, Vector):
            return self._applied(other)
        if isinstance(other, Matrix):
            if len(self._rows[0]) != len(other._rows):
                raise ValueError(f"Matrix product: a {self._shape()} cannot be multiplied by a {other._shape()}")
            if len(self._rows) == 3 and len(self._rows[0]) == 3 and len(other._rows[0]) == 3:
                return Matrix._wrap(
                    rotations.rows_of(rotations.product(rotations.nine(self._rows), rotations.nine(other._rows)))
                )
            return Matrix._wrap(product_rows(self._rows, other._rows))
        if is_number(other):
            return Matrix._wrap([[value * float(other) for value in row] for row in self._rows])
        return NotImplemented

    @overload
    def __matmul__(self, other: Matrix) -> Matrix: ...
    @overload
    def __matmul__(self, other: Vector) -> Vector: ...
    def __matmul__(self, other: object) -> Any:
        if isinstance(other, (Matrix, Vector)):
            return self * other
        return NotImplemented

    @overload
    def __rmul__(self, other: float) -> Matrix: ...
    @overload
    def __rmul__(self, other: Vector) -> Vector: ...
    def __rmul__(self, other: Any) -> Any:
        if is_number(other):
            return self * float(other)
        if isinstance(other, Vector):
            return self._applied_to_row(other)
        return NotImplemented

    def __rmatmul__(self, other: object) -> object:
        return self._applied_to_row(other) if isinstance(other, Vector) else NotImplemented

    def _applied(self, vector: Vector) -> Vector:
        items: Sequence[float] = vector._items
        width = len(self._rows[0])
        if len(items) == 3 and width == 3 and len(self._rows) == 3:
            x, y, z = items
            return Vector._wrap([a * x + b * y + c * z for a, b, c in self._rows])
        rows: Sequence[list[float]] = self._rows
        if len(items) == 3 and width == 4:
            items = (*items, 1.0)
            rows = self._rows[:3]
        if len(items) != width:
            raise ValueError(f"Matrix * Vector: a {self._shape()} cannot be multiplied by a vector of {len(items)}")
        return Vector._wrap([sum(map(mul, row, items)) for row in rows])

    def _applied_to_row(self, vector: Vector) -> Vector:
        items: Sequence[float] = vector._items
        columns = transposed_rows(self._rows)
        if len(items) == 3 and len(self._rows) == 4:
            items = (*items, 1.0)
            columns = columns[:3]
        if len(items) != len(self._rows):
            raise ValueError(f"Vector * Matrix: a vector of {len(items)} cannot be multiplied by a {self._shape()}")
        return Vector._wrap([sum(map(mul, column, items)) for column in columns])

    def __add__(self, other: Matrix) -> Matrix:
        return self._combined(other, 1.0) if isinstance(other, Matrix) else NotImplemented

    def __sub__(self, other: Matrix) -> Matrix:
        return self._combined(other, -1.0) if isinstance(other, Matrix) else NotImplemented

    def __neg__(self) -> Matrix:
        return self * -1.0

    def _combined(self, other: Matrix, factor: float) -> Matrix:
        if self._shape() != other._shape():
            raise ValueError(f"Matrix sum: both must have the same shape, given {self._shape()} and {other._shape()}")
        return Matrix._wrap([
            [a + factor * b for a, b in zip(p, q, strict=True)] for p, q in zip(self._rows, other._rows, strict=True)
        ])  # fmt: skip

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Matrix):
            return NotImplemented
        return [list(row) for row in self._rows] == [list(row) for row in other._rows]

    def __hash__(self) -> int:
        if not self.is_frozen:
            raise TypeError("unhashable type: 'Matrix'; freeze() it first")
        return hash(tuple(self._rows))

    @property
    def is_frozen(self) -> bool:
        """Whether `freeze` was called."""
        return isinstance(self._rows, tuple)

    def freeze(self) -> Self:
        """Make the matrix immutable, so that it can be a key of a dictionary. Return the matrix."""
        self._rows = tuple(tuple(row) for row in self._rows)  # type: ignore[assignment]
        return self

    def _become(self, rows: Rows) -> None:
        if self.is_frozen:
            raise TypeError("this Matrix is frozen: modify a copy() of it")
        for mine, new in zip(self._rows, rows, strict=True):
            mine[:] = new

    # algebra -------------------------------------------------------------------------------------

    def transposed(self) -> Matrix:
        """Return the transposed matrix."""
        return Matrix._wrap(transposed_rows(self._rows))

    def transpose(self) -> None:
        """Transpose a square matrix in place."""
        self._check_square("transpose")
        self._become(transposed_rows(self._rows))

    def determinant(self) -> float:
        """Return the determinant of a square matrix."""
        self._check_square("determinant")
        return determinant_of_rows(self._rows)

    def inverted(self, fallback: object = ...) -> Any:
        """Return the inverse.

        Raises:
            ValueError: the matrix is singular, and no fallback is given.
        """
        self._check_square("inverted")
        inverse = inverted_rows(self._rows)
        if inverse is not None:
            return Matrix._wrap(inverse)
        if fallback is ...:
            raise ValueError(f"Matrix.inverted: this matrix has no inverse: {self!r}")
        return fallback

    def inverted_safe(self) -> Matrix:
        """Return the inverse; if there is none, the inverse of the matrix with a small number added to its diagonal."""
        self._check_square("inverted_safe")
        inverse = inverted_rows(self._rows)
        if inverse is None:
            inverse = inverted_rows(
                [[value + (1e-8 if i == j else 0.0) for j, value in enumerate(row)] for i, row in enumerate(self._rows)]
            )
        return Matrix._wrap(identity_rows(len(self._rows)) if inverse is None else inverse)

    def invert(self, fallback: Matrix | None = None) -> None:
        """Invert the matrix in place; if it is singular, the result is the fallback.

        Raises:
            ValueError: the matrix is singular, and no fallback is given.
        """
        inverse = self.inverted() if fallback is None else self.inverted(fallback)
        self._become(inverse._rows)

    def invert_safe(self) -> None:
        """Invert the matrix in place, as `inverted_safe` does."""
        self._become(self.inverted_safe()._rows)

    def identity(self) -> None:
        """Set the matrix to the identity."""
        self._check_square("identity")
        self._become(identity_rows(len(self._rows)))

    def zero(self) -> None:
        """Set all items to 0."""
        self._become([[0.0] * len(row) for row in self._rows])

    def _check_square(self, what: str) -> None:
        if len(self._rows) != len(self._rows[0]):
            raise ValueError(f"Matrix.{what}: needs a square matrix, given a {self._shape()}")

    def normalized(self) -> Matrix:
        """Return the matrix with its (first three) columns scaled to length 1: rotation without scale."""
        matrix = self.copy()
        matrix.normalize()
        return matrix

    def normalize(self) -> None:
        """Scale the (first three) columns to length 1."""
        if len(self._rows) < 3:
            raise ValueError(f"Matrix.normalize: needs a 3x3 or 4x4 matrix, given a {self._shape()}")
        upper = rotations.rows_of(rotations.normalized_columns(rotations.nine(self._rows)))
        rows = [[*new, *row[3:]] for new, row in zip(upper, self._rows, strict=False)]
        self._become([*rows, *(list(row) for row in self._rows[3:])])

    def lerp(self, other: Matrix, factor: float) -> Matrix:
        """Interpolate between two poses: positions and scales linearly, the rotation along the shorter path."""
        if len(self._rows) < 3 or self._shape() != other._shape():
            raise ValueError(f"Matrix.lerp: needs two 3x3 or 4x4 matrices, given {self._shape()} and {other._shape()}")
        (p, q, s), (p2, q2, s2) = self.to_4x4().decompose(), other.to_4x4().decompose()
        mixed = Matrix.LocRotScale(p.lerp(p2, factor), q.slerp(q2, factor), s.lerp(s2, factor))
        return mixed if len(self._rows) == 4 else mixed.to_3x3()

    # parts ---------------------------------------------------------------------------------------

    def as_rotation(self) -> rotations.Rotation9:
        """Return the upper left 3x3, row by row, unchanged."""
        if len(self._rows) < 3 or len(self._rows[0]) < 3:
            raise ValueError(f"a rotation needs a 3x3 or 4x4 Matrix, given a {self._shape()}")
        return rotations.nine(self._rows)

    def to_2x2(self) -> Matrix:
        """Return the upper left 2x2."""
        return Matrix._wrap([list(row[:2]) for row in self._rows[:2]])

    def to_3x3(self) -> Matrix:
        """Return the upper left 3x3; missing items are those of the identity."""
        return self._resized(3)

    def to_4x4(self) -> Matrix:
        """Return a 4x4 matrix; missing items are those of the identity."""
        return self._resized(4)

    def resize_4x4(self) -> None:
        """Resize to 4x4; rows and columns that were accessed before are no longer connected to the matrix."""
        self._rows = self.to_4x4()._rows

    def _resized(self, size: int) -> Matrix:
        rows = identity_rows(size)
        for new, row in zip(rows, self._rows, strict=False):
            width = min(size, len(row))
            new[:width] = row[:width]
        return Matrix._wrap(rows)

    def to_translation(self) -> Vector:
        """Return a copy of the translation."""
        return self.translation.copy()

    def to_scale(self) -> Vector:
        """Return the lengths of the first three columns, all negative for a mirroring matrix."""
        nine = self.as_rotation()
        sign = -1.0 if rotations.determinant(nine) < 0.0 else 1.0
        return Vector([sign * Vector._wrap(list(nine[i::3])).length for i in range(3)])

    @property
    def median_scale(self) -> float:
        """The mean length of the first three columns."""
        return sum(abs(value) for value in self.to_scale()) / 3.0

    @property
    def is_negative(self) -> bool:
        """Whether the matrix mirrors."""
        return rotations.determinant(self.as_rotation()) < 0.0

    @property
    def is_orthogonal(self) -> bool:
        """Whether the axes are perpendicular unit vectors, to five digits."""
        columns = transposed_rows(rotations.rows_of(self.as_rotation()))
        return all(
            abs(sum(a * b for a, b in zip(p, q, strict=True)) - (i == j)) < 1e-5
            for i, p in enumerate(columns)
            for j, q in enumerate(columns)
        )

    is_orthogonal_axis_vectors = is_orthogonal

    def to_quaternion(self) -> Quaternion:
        """Return the rotation as a unit quaternion with w >= 0; scale and mirroring are ignored."""
        return Quaternion._wrap(list(rotations.quaternion_from_rotation(rotations.unscaled(self.as_rotation()))))

    def to_euler(self, order: str = "XYZ", compatible: Iterable[float] | None = None) -> Euler:
        """Return the rotation as Euler angles in the given order.

        Args:
            order: one of the six orders.
            compatible: return the solution closest to these angles, instead of the solution with the smallest angles.
        """
        rotations.checked_order(order)
        nine = rotations.unscaled(self.as_rotation())
        if compatible is None:
            return Euler(rotations.euler_from_rotation(nine, order), order)
        near = floats(compatible, "Matrix.to_euler compatible", 3, 3)
        return Euler(rotations.compatible_euler(nine, order, near), order)

    def decompose(self) -> tuple[Vector, Quaternion, Vector]:
        """Return translation, rotation and scale of a 4x4 matrix; all scales are negative if it mirrors."""
        if self._shape() != "4x4":
            raise ValueError(f"Matrix.decompose: needs a 4x4 matrix, given a {self._shape()}")
        return self.to_translation(), self.to_quaternion(), self.to_scale()

    def rotate(self, other: Euler | Quaternion | Matrix) -> None:
        """Apply another rotation, about the fixed axes, to a 3x3 matrix."""
        if self._shape() != "3x3":
            raise ValueError(f"Matrix.rotate: needs a 3x3 matrix, given a {self._shape()}")
        self._become(rotations.rows_of(rotations.product(other.as_rotation(), self.as_rotation())))

    # copies and text -----------------------------------------------------------------------------

    def copy(self) -> Self:
        """Return a copy that is not frozen."""
        return self._wrap([list(row) for row in self._rows])

    __copy__ = copy

    def __deepcopy__(self, memo: dict[int, object]) -> Self:
        return self.copy()

    def __reduce__(self) -> tuple[Callable[..., object], tuple[object, ...]]:
        return type(self), (tuple(tuple(row) for row in self._rows),)

    def __repr__(self) -> str:
        lines = [f"({', '.join(map(rounded, row))})" for row in self._rows]
        return f"Matrix(({', '.join(lines)}))"


collections.abc.Sequence.register(Matrix)
