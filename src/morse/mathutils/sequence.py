"""Short sequences of floats of fixed length, the base of vectors, angles and colours; and the algebra of vectors."""

from __future__ import annotations

import collections.abc
from math import atan2, hypot, sin
from numbers import Real
from operator import add, mul, sub
from typing import TYPE_CHECKING, Any, ClassVar, Self, SupportsFloat, SupportsIndex, overload

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, MutableSequence, Sequence

    _Base = Sequence[float]
else:
    _Base = object


def floats(values: Iterable[SupportsFloat], kind: str, smallest: int, largest: int) -> list[float]:
    """Return the values as floats.

    Raises:
        TypeError: the values are not numbers.
        ValueError: there are fewer than `smallest` or more than `largest` of them.
    """
    try:
        row = [float(value) for value in values]
    except (TypeError, ValueError):
        raise TypeError(f"{kind} takes {_count(smallest, largest)} numbers, given {values!r}") from None
    if not smallest <= len(row) <= largest:
        raise ValueError(f"{kind} takes {_count(smallest, largest)} numbers, given {len(row)}: {values!r}")
    return row


def is_number(value: object) -> bool:
    """Whether a value is an int, a float or a scalar of numpy."""
    return isinstance(value, (float, int, Real))


def rounded(value: float) -> str:
    """Return a component in the format of Blender: at most four decimals."""
    return f"{value:.4f}"


def _count(smallest: int, largest: int) -> str:
    return str(smallest) if smallest == largest else f"{smallest} to {largest}"


class FloatSequence(_Base):
    """A sequence of floats whose length does not change when items are assigned.

    The items are in `_items`: a list, a tuple after `freeze`, or the row or column of a matrix.
    """

    __slots__ = ("_items",)
    _items: MutableSequence[float]
    _sizes: ClassVar[tuple[int, int]]

    @classmethod
    def _wrap(cls, items: MutableSequence[float]) -> Self:
        """Create an instance from these items, which are neither copied nor checked."""
        sequence = cls.__new__(cls)
        sequence._items = items
        return sequence

    def __len__(self) -> int:
        return len(self._items)

    def __iter__(self) -> Iterator[float]:
        return iter(self._items)

    @overload
    def __getitem__(self, index: SupportsIndex) -> float: ...
    @overload
    def __getitem__(self, index: slice) -> tuple[float, ...]: ...
    def __getitem__(self, index: Any) -> Any:
        if isinstance(index, slice):
            return tuple(self._items[index])
        return self._items[index]

    @overload
    def __setitem__(self, index: SupportsIndex, value: float) -> None: ...
    @overload
    def __setitem__(self, index: slice, value: Iterable[float]) -> None: ...
    def __setitem__(self, index: Any, value: Any) -> None:
        if isinstance(index, slice):
            row = list(self._items)
            size = len(row)
            row[index] = floats(value, f"a slice of {type(self).__name__}", 0, size)
            if len(row) != size:
                raise ValueError(
                    f"the slice of {type(self).__name__} takes as many numbers as it has items, given {value!r}"
                )
            self._assign(row)
            return
        self._check_writable()
        try:
            self._items[index] = float(value)
        except (TypeError, ValueError):
            raise TypeError(f"{type(self).__name__} items are numbers, given {value!r} for {index!r}") from None

    def _assign(self, values: Sequence[float]) -> None:
        self._check_writable()
        self._items[:] = values

    def _check_writable(self) -> None:
        if isinstance(self._items, tuple):
            raise TypeError(f"this {type(self).__name__} is frozen: assign to a copy() of it")

    def __eq__(self, other: object) -> bool:
        if type(other) is not type(self):
            return NotImplemented
        return list(self._items) == list(other._items)

    def __hash__(self) -> int:
        if not isinstance(self._items, tuple):
            raise TypeError(f"unhashable type: '{type(self).__name__}'; freeze() it first")
        return hash(self._items)

    @property
    def is_frozen(self) -> bool:
        """Whether `freeze` was called."""
        return isinstance(self._items, tuple)

    def freeze(self) -> Self:
        """Make the object immutable, so that it can be a key of a dictionary. Return the object."""
        self._items = tuple(self._items)  # type: ignore[assignment]
        return self

    def copy(self) -> Self:
        """Return a copy that is not frozen, and not a view of a matrix."""
        return self._wrap(list(self._items))

    __copy__ = copy

    def __deepcopy__(self, memo: dict[int, object]) -> Self:
        return self.copy()

    def __reduce__(self) -> tuple[Callable[..., object], tuple[object, ...]]:
        return type(self), (tuple(self._items),)


collections.abc.Sequence.register(FloatSequence)


_AXES = {"x": 0, "y": 1, "z": 2, "w": 3}


class VectorAlgebra(FloatSequence):
    """The part of `morse.mathutils.Vector` that does not depend on rotations.

    Attributes:
        _plain: the class of results, `morse.mathutils.Vector`, even if an operand is of a subclass.
    """

    __slots__ = ()
    _sizes: ClassVar[tuple[int, int]] = (2, 4)
    _plain: type[Self]

    def __init__(self, values: Iterable[SupportsFloat] = (0.0, 0.0, 0.0)) -> None:
        self._items = floats(values, "Vector", 2, 4)

    def __repr__(self) -> str:
        return f"Vector(({', '.join(map(rounded, self._items))}))"

    # components ----------------------------------------------------------------------------------

    @property
    def x(self) -> float:
        """First component."""
        return self._items[0]

    @x.setter
    def x(self, value: float) -> None:
        self[0] = value

    @property
    def y(self) -> float:
        """Second component."""
        return self._items[1]

    @y.setter
    def y(self, value: float) -> None:
        self[1] = value

    @property
    def z(self) -> float:
        """Third component, of vectors with at least three."""
        return self._items[self._axis(2)]

    @z.setter
    def z(self, value: float) -> None:
        self[self._axis(2)] = value

    @property
    def w(self) -> float:
        """Fourth component, of vectors with four."""
        return self._items[self._axis(3)]

    @w.setter
    def w(self, value: float) -> None:
        self[self._axis(3)] = value

    def _axis(self, index: int) -> int:
        if index >= len(self._items):
            raise AttributeError(f"a Vector of {len(self._items)} components has no '{'xyzw'[index]}'")
        return index

    @property
    def xy(self) -> Self:
        """The first two components."""
        return self._plain._wrap(list(self._items[:2]))

    @xy.setter
    def xy(self, values: Iterable[float]) -> None:
        self[:2] = values

    @property
    def xyz(self) -> Self:
        """The first three components."""
        return self._plain._wrap(list(self._items[: self._axis(2) + 1]))

    @xyz.setter
    def xyz(self, values: Iterable[float]) -> None:
        self[: self._axis(2) + 1] = values

    if not TYPE_CHECKING:

        def __getattr__(self, name: str) -> Self:
            """Any other swizzle, such as ``v.zx``."""
            if 2 <= len(name) <= 4 and all(letter in _AXES for letter in name):
                return self._plain._wrap([self._items[self._axis(_AXES[letter])] for letter in name])
            if name in _AXES:
                self._axis(_AXES[name])
            raise AttributeError(f"'Vector' object has no attribute '{name}'")

    # arithmetic ----------------------------------------------------------------------------------

    def __add__(self, other: VectorAlgebra) -> Self:
        if not isinstance(other, VectorAlgebra):
            return NotImplemented
        self._same_size(other, "+")
        return self._plain._wrap(list(map(add, self._items, other._items)))

    def __sub__(self, other: VectorAlgebra) -> Self:
        if not isinstance(other, VectorAlgebra):
            return NotImplemented
        self._same_size(other, "-")
        return self._plain._wrap(list(map(sub, self._items, other._items)))

    def __iadd__(self, other: VectorAlgebra) -> Self:
        if not isinstance(other, VectorAlgebra):
            return NotImplemented
        self._same_size(other, "+=")
        self._assign(list(map(add, self._items, other._items)))
        return self

    def __isub__(self, other: VectorAlgebra) -> Self:
        if not isinstance(other, VectorAlgebra):
            return NotImplemented
        self._same_size(other, "-=")
        self._assign(list(map(sub, self._items, other._items)))
        return self

    def __neg__(self) -> Self:
        return self._plain._wrap([-a for a in self._items])

    def __pos__(self) -> Self:
        return self.copy()

    @overload
    def __mul__(self, other: VectorAlgebra) -> float: ...
    @overload
    def __mul__(self, other: float) -> Self: ...
    def __mul__(self, other: Any) -> Any:
        if isinstance(other, VectorAlgebra):
            return self.dot(other)
        if is_number(other):
            return self._plain._wrap([a * float(other) for a in self._items])
        return NotImplemented

    def __rmul__(self, other: float) -> Self:
        if not is_number(other):
            return NotImplemented
        return self._plain._wrap([a * float(other) for a in self._items])

    def __imul__(self, other: Any) -> Self:  # type: ignore[misc]
        product = self * other
        if not isinstance(product, VectorAlgebra):
            raise TypeError(f"v *= {type(other).__name__} is not a vector: use v.dot(other)")
        self._assign(product._items)
        return self

    def __matmul__(self, other: VectorAlgebra) -> float:
        if not isinstance(other, VectorAlgebra):
            return NotImplemented
        return self.dot(other)

    def __truediv__(self, other: float) -> Self:
        if not is_number(other):
            return NotImplemented
        return self._plain._wrap([a / float(other) for a in self._items])

    def __itruediv__(self, other: float) -> Self:
        if not is_number(other):
            return NotImplemented
        self._assign([a / float(other) for a in self._items])
        return self

    def _same_size(self, other: VectorAlgebra, what: str) -> None:
        if len(self._items) != len(other._items):
            raise ValueError(
                f"Vector {what}: both must have the same number of components, given {len(self._items)} and "
                f"{len(other._items)}"
            )

    def dot(self, other: Iterable[float]) -> float:
        """Return the sum of the products of the components."""
        b = self._operand(other, "dot")
        total: float = sum(map(mul, self._items, b._items))
        return total

    def cross(self, other: Iterable[float]) -> Self:
        """Return the cross product of two 3-vectors."""
        b = self._operand(other, "cross")
        if len(self._items) != 3:
            raise ValueError(f"Vector.cross: needs 3 components, given {len(self._items)}")
        ax, ay, az = self._items
        bx, by, bz = b._items
        return self._plain._wrap([ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx])

    def _operand(self, other: Iterable[float], what: str) -> VectorAlgebra:
        vector = other if isinstance(other, VectorAlgebra) else self._plain(other)
        self._same_size(vector, what)
        return vector

    # length and direction ------------------------------------------------------------------------

    @property
    def length(self) -> float:
        """Euclidean length; assigning to it keeps the direction."""
        return hypot(*self._items)

    @length.setter
    def length(self, value: float) -> None:
        if value < 0.0:
            raise ValueError(f"Vector.length: cannot be negative, given {value!r}")
        length = self.length
        if length > 0.0:
            self._assign([a * (value / length) for a in self._items])

    magnitude = length

    @property
    def length_squared(self) -> float:
        """The square of the length."""
        total: float = sum(map(mul, self._items, self._items))
        return total

    def normalized(self) -> Self:
        """Return the vector of length 1 in this direction; a zero vector stays zero."""
        length = self.length
        return self._plain._wrap([a / length for a in self._items]) if length > 0.0 else self.copy()

    def normalize(self) -> None:
        """Scale the length to 1."""
        self._assign(self.normalized()._items)

    def zero(self) -> None:
        """Set all components to 0."""
        self._assign([0.0] * len(self._items))

    def negate(self) -> None:
        """Reverse the direction."""
        self._assign([-a for a in self._items])

    def angle(self, other: Iterable[float], fallback: object = ...) -> Any:
        """Return the angle to another vector, 0 to pi radians.

        Args:
            other: a vector with the same number of components.
            fallback: returned if one of the two is zero.

        Raises:
            ValueError: one of the two is zero, and no fallback is given.
        """
        b = self._operand(other, "angle")
        if self.length == 0.0 or b.length == 0.0:
            if fallback is ...:
                raise ValueError("Vector.angle: a zero vector has no direction; give a fallback to allow it")
            return fallback
        p, q = self.normalized(), b.normalized()
        # W. Kahan, "How futile are mindless assessments of roundoff" (2006): accurate for small angles, unlike acos.
        return 2.0 * atan2((p - q).length, (p + q).length)

    def lerp(self, other: Iterable[float], factor: float) -> Self:
        """Interpolate linearly to another vector; `factor` 0 returns this vector, 1 the other."""
        b = self._operand(other, "lerp")
        return self._plain._wrap([p + (q - p) * factor for p, q in zip(self._items, b._items, strict=True)])

    def slerp(self, other: Iterable[float], factor: float, fallback: object = ...) -> Any:
        """Return the interpolated direction, of length 1.

        Raises:
            ValueError: one of the two is zero, or they are opposite, and no fallback is given.
        """
        b = self._operand(other, "slerp")
        p, q = self.normalized(), b.normalized()
        if not p.length or not q.length or (p + q).length < 1e-12:
            if fallback is ...:
                raise ValueError("Vector.slerp: there is no direction between zero or opposite vectors")
            return fallback
        angle = p.angle(q)
        if angle < 1e-9:
            return p.lerp(q, factor).normalized()
        return p * (sin((1.0 - factor) * angle) / sin(angle)) + q * (sin(factor * angle) / sin(angle))

    def project(self, other: Iterable[float]) -> Self:
        """Return the projection of this vector on another; zero if the other is zero."""
        b = self._operand(other, "project")
        squared = b.length_squared
        share = self.dot(b) / squared if squared > 0.0 else 0.0
        return self._plain._wrap([a * share for a in b])

    def reflect(self, mirror: Iterable[float]) -> Self:
        """Return the reflection of this vector at a mirror with the given normal."""
        normal = self._operand(mirror, "reflect").normalized()
        return self - normal * (2.0 * self.dot(normal))

    # conversion ----------------------------------------------------------------------------------

    def to_tuple(self, precision: int = -1) -> tuple[float, ...]:
        """Return the components as a tuple, rounded to `precision` digits unless it is negative."""
        return tuple(self._items) if precision < 0 else tuple(round(a, precision) for a in self._items)

    def resized(self, size: int) -> Self:
        """Return a copy with `size` components: truncated, or filled with 0."""
        if not 2 <= size <= 4:
            raise ValueError(f"a Vector has 2 to 4 components, asked for {size}")
        return self._plain._wrap([*self._items, 0.0, 0.0][:size])

    def to_2d(self) -> Self:
        """Return the first two components."""
        return self.resized(2)

    def to_3d(self) -> Self:
        """Return the first three components; z = 0 if there are only two."""
        return self.resized(3)

    def to_4d(self) -> Self:
        """Return four components; w = 1 if there are fewer."""
        vector = self.resized(4)
        if len(self._items) < 4:
            vector._items[3] = 1.0
        return vector

    def resize(self, size: int) -> None:
        """Change the number of components; a row or column of a matrix is then no longer connected to the matrix."""
        self._check_writable()
        self._items = self.resized(size)._items

    def resize_2d(self) -> None:
        """Keep the first two components."""
        self.resize(2)

    def resize_3d(self) -> None:
        """Change the number of components to three."""
        self.resize(3)

    def resize_4d(self) -> None:
        """Change the number of components to four."""
        self._check_writable()
        self._items = self.to_4d()._items

    def orthogonal(self) -> Self:
        """Return a vector perpendicular to this one."""
        if len(self._items) == 2:
            x, y = self._items
            return self._plain._wrap([-y, x])
        x, y, z = self.to_3d()
        if abs(x) <= abs(y) and abs(x) <= abs(z):
            return self._plain._wrap([0.0, -z, y])
        return self._plain._wrap([z, 0.0, -x]) if abs(y) <= abs(z) else self._plain._wrap([-y, x, 0.0])

    @classmethod
    def Fill(cls, size: int, fill: float = 0.0) -> Self:  # noqa: N802 (Blender's name)
        """Return a vector of equal components."""
        return cls([fill] * size)
