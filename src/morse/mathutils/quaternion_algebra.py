"""Components and arithmetic of quaternions."""

from __future__ import annotations

from math import atan2, cos, pi, sin, sqrt
from typing import TYPE_CHECKING, ClassVar, Self, SupportsFloat

from morse.mathutils.sequence import FloatSequence, floats, is_number, rounded

if TYPE_CHECKING:
    from collections.abc import Iterable


class QuaternionAlgebra(FloatSequence):
    """The part of `morse.mathutils.Quaternion` that does not depend on vectors and matrices.

    Attributes:
        _plain: the class of results, `morse.mathutils.Quaternion`, even if an operand is of a subclass.
    """

    __slots__ = ()
    _sizes: ClassVar[tuple[int, int]] = (4, 4)
    _plain: type[Self]

    def __init__(self, values: Iterable[SupportsFloat] = (1.0, 0.0, 0.0, 0.0), angle: float | None = None) -> None:
        if angle is not None:
            self._items = about(floats(values, "Quaternion: an axis with an angle", 3, 3), float(angle))
            return
        row = floats(values, "Quaternion", 3, 4)
        self._items = row if len(row) == 4 else about(row, sqrt(sum(a * a for a in row)))

    def __repr__(self) -> str:
        return f"Quaternion(({', '.join(map(rounded, self._items))}))"

    @property
    def w(self) -> float:
        """Real part."""
        return self._items[0]

    @w.setter
    def w(self, value: float) -> None:
        self[0] = value

    @property
    def x(self) -> float:
        """First imaginary component."""
        return self._items[1]

    @x.setter
    def x(self, value: float) -> None:
        self[1] = value

    @property
    def y(self) -> float:
        """Second imaginary component."""
        return self._items[2]

    @y.setter
    def y(self, value: float) -> None:
        self[2] = value

    @property
    def z(self) -> float:
        """Third imaginary component."""
        return self._items[3]

    @z.setter
    def z(self, value: float) -> None:
        self[3] = value

    # arithmetic ----------------------------------------------------------------------------------

    def __add__(self, other: QuaternionAlgebra) -> Self:
        if not isinstance(other, QuaternionAlgebra):
            return NotImplemented
        return self._plain._wrap([a + b for a, b in zip(self._items, other._items, strict=True)])

    def __sub__(self, other: QuaternionAlgebra) -> Self:
        if not isinstance(other, QuaternionAlgebra):
            return NotImplemented
        return self._plain._wrap([a - b for a, b in zip(self._items, other._items, strict=True)])

    def __neg__(self) -> Self:
        return self._plain._wrap([-a for a in self._items])

    def __truediv__(self, other: float) -> Self:
        if not is_number(other):
            return NotImplemented
        return self._plain._wrap([a / float(other) for a in self._items])

    def cross(self, other: Iterable[float]) -> Self:
        """Return the Hamilton product: the rotation `other`, then this one."""
        aw, ax, ay, az = self._items
        bw, bx, by, bz = self._operand(other)._items
        return self._plain._wrap([
            aw * bw - ax * bx - ay * by - az * bz,
            aw * bx + ax * bw + ay * bz - az * by,
            aw * by - ax * bz + ay * bw + az * bx,
            aw * bz + ax * by - ay * bx + az * bw,
        ])  # fmt: skip

    def dot(self, other: Iterable[float]) -> float:
        """Return the sum of the products of the components."""
        return sum(a * b for a, b in zip(self._items, self._operand(other)._items, strict=True))

    @property
    def magnitude(self) -> float:
        """The norm; 1 for a rotation."""
        return sqrt(sum(a * a for a in self._items))

    def conjugated(self) -> Self:
        """Return the quaternion with a negated imaginary part."""
        w, x, y, z = self._items
        return self._plain._wrap([w, -x, -y, -z])

    def conjugate(self) -> None:
        """Negate the imaginary part."""
        self._assign(self.conjugated()._items)

    def inverted(self) -> Self:
        """Return the inverse; the zero quaternion stays zero."""
        squared = self.dot(self)
        return self.conjugated() / squared if squared > 0.0 else self.copy()

    def invert(self) -> None:
        """Invert the quaternion in place."""
        self._assign(self.inverted()._items)

    def normalized(self) -> Self:
        """Return the unit quaternion of this rotation; the zero quaternion stays zero."""
        magnitude = self.magnitude
        return self / magnitude if magnitude > 0.0 else self.copy()

    def normalize(self) -> None:
        """Scale the norm to 1."""
        self._assign(self.normalized()._items)

    def negate(self) -> None:
        """Negate all components; the rotation does not change."""
        self._assign([-a for a in self._items])

    def identity(self) -> None:
        """Set the quaternion to the identity."""
        self._assign([1.0, 0.0, 0.0, 0.0])

    # rotation ------------------------------------------------------------------------------------

    def slerp(self, other: Iterable[float], factor: float) -> Self:
        """Interpolate to another rotation along the shorter path; `factor` is 0 to 1.

        K. Shoemake, "Animating rotation with quaternion curves", SIGGRAPH 1985.
        """
        if not 0.0 <= factor <= 1.0:
            raise ValueError(f"Quaternion.slerp: the factor is between 0 and 1, given {factor!r}")
        a, b = self.normalized(), self._operand(other).normalized()
        if a.dot(b) < 0.0:
            b = -b
        angle = 2.0 * atan2((a - b).magnitude, (a + b).magnitude)
        if angle < 1e-9:
            return self._mixed(a, 1.0 - factor, b, factor).normalized()
        return self._mixed(a, sin((1.0 - factor) * angle) / sin(angle), b, sin(factor * angle) / sin(angle))

    def _mixed(self, a: QuaternionAlgebra, share: float, b: QuaternionAlgebra, other: float) -> Self:
        return self._plain._wrap([p * share + q * other for p, q in zip(a._items, b._items, strict=True)])

    def rotation_difference(self, other: Iterable[float]) -> Self:
        """Return the quaternion d with ``self * d == other``."""
        return self.inverted().cross(other)

    def make_compatible(self, other: Iterable[float]) -> None:
        """Choose the sign for which the quaternion is closer to another quaternion."""
        if self.dot(other) < 0.0:
            self.negate()

    def _operand(self, values: Iterable[float]) -> QuaternionAlgebra:
        if isinstance(values, QuaternionAlgebra):
            return values
        return self._plain(floats(values, "Quaternion", 4, 4))


def wrapped(angle: float) -> float:
    """Return the angle without whole turns, -pi to pi."""
    return angle - 2.0 * pi * round(angle / (2.0 * pi))


def about(axis: list[float], angle: float) -> list[float]:
    """Return w, x, y, z of the rotation about an axis of any length."""
    x, y, z = axis
    length = sqrt(x * x + y * y + z * z)
    if length == 0.0:
        return [1.0, 0.0, 0.0, 0.0]
    half = wrapped(angle) / 2.0
    scale = sin(half) / length
    return [cos(half), x * scale, y * scale, z * scale]
