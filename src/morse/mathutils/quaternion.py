"""Quaternions."""

from __future__ import annotations

from math import acos, atan2, cos, pi, sin, sqrt
from typing import TYPE_CHECKING, Any, ClassVar, overload

from morse.mathutils import matrix as matrices
from morse.mathutils import rotations
from morse.mathutils.sequence import FloatSequence, floats, is_number, rounded
from morse.mathutils.vector import Vector

if TYPE_CHECKING:
    from collections.abc import Iterable

    from morse.mathutils.euler import Euler
    from morse.mathutils.matrix import Matrix


class Quaternion(FloatSequence):
    """A quaternion w, x, y, z; ``Quaternion()`` is no rotation.

    ``Quaternion((w, x, y, z))``, ``Quaternion((x, y, z), angle)`` from an axis and radians, or
    ``Quaternion((x, y, z))`` from an exponential map: the axis times the angle.
    ``a * b`` and ``a @ b`` are the Hamilton product, ``q * v`` turns a 3-vector.
    """

    __slots__ = ()
    _sizes: ClassVar[tuple[int, int]] = (4, 4)

    def __init__(self, values: Iterable[Any] = (1.0, 0.0, 0.0, 0.0), angle: float | None = None) -> None:
        if angle is not None:
            self._items = _about(floats(values, "Quaternion: an axis with an angle", 3, 3), float(angle))
            return
        row = floats(values, "Quaternion", 3, 4)
        self._items = row if len(row) == 4 else _about(row, sqrt(sum(a * a for a in row)))

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

    def __add__(self, other: Quaternion) -> Quaternion:
        if not isinstance(other, Quaternion):
            return NotImplemented
        return Quaternion._wrap([a + b for a, b in zip(self._items, other._items, strict=True)])

    def __sub__(self, other: Quaternion) -> Quaternion:
        if not isinstance(other, Quaternion):
            return NotImplemented
        return Quaternion._wrap([a - b for a, b in zip(self._items, other._items, strict=True)])

    def __neg__(self) -> Quaternion:
        return Quaternion._wrap([-a for a in self._items])

    @overload
    def __mul__(self, other: Quaternion | float) -> Quaternion: ...
    @overload
    def __mul__(self, other: Vector) -> Vector: ...
    def __mul__(self, other: Any) -> Any:
        if isinstance(other, Quaternion):
            return self.cross(other)
        if isinstance(other, Vector):
            return self._turned(other)
        if is_number(other):
            return Quaternion._wrap([a * float(other) for a in self._items])
        return NotImplemented

    def __rmul__(self, other: Any) -> Any:
        if is_number(other):
            return Quaternion._wrap([a * float(other) for a in self._items])
        if isinstance(other, Vector):
            return self._turned(other)
        return NotImplemented

    @overload
    def __matmul__(self, other: Quaternion) -> Quaternion: ...
    @overload
    def __matmul__(self, other: Vector) -> Vector: ...
    def __matmul__(self, other: Any) -> Any:
        if isinstance(other, (Quaternion, Vector)):
            return self * other
        return NotImplemented

    def __truediv__(self, other: float) -> Quaternion:
        if not is_number(other):
            return NotImplemented
        return Quaternion._wrap([a / float(other) for a in self._items])

    def _turned(self, vector: Vector) -> Vector:
        if len(vector) != 3:
            raise ValueError(f"a Quaternion turns vectors of 3 components, given {len(vector)}")
        w, x, y, z = self._items
        vx, vy, vz = vector
        tx, ty, tz = 2 * (y * vz - z * vy), 2 * (z * vx - x * vz), 2 * (x * vy - y * vx)
        return Vector._wrap(
            [vx + w * tx + y * tz - z * ty, vy + w * ty + z * tx - x * tz, vz + w * tz + x * ty - y * tx]
        )

    def cross(self, other: Iterable[float]) -> Quaternion:
        """Hamilton product: the rotation `other`, then this one."""
        aw, ax, ay, az = self._items
        bw, bx, by, bz = _quaternion(other)._items
        return Quaternion._wrap([
            aw * bw - ax * bx - ay * by - az * bz,
            aw * bx + ax * bw + ay * bz - az * by,
            aw * by - ax * bz + ay * bw + az * bx,
            aw * bz + ax * by - ay * bx + az * bw,
        ])  # fmt: skip

    def dot(self, other: Iterable[float]) -> float:
        """Sum of the products of the components."""
        return sum(a * b for a, b in zip(self._items, _quaternion(other)._items, strict=True))

    @property
    def magnitude(self) -> float:
        """Norm; 1 for a rotation."""
        return sqrt(sum(a * a for a in self._items))

    def conjugated(self) -> Quaternion:
        """The quaternion with its imaginary part negated."""
        w, x, y, z = self._items
        return Quaternion._wrap([w, -x, -y, -z])

    def conjugate(self) -> None:
        """Negate the imaginary part."""
        self._assign(self.conjugated()._items)

    def inverted(self) -> Quaternion:
        """The inverse; null for the null quaternion."""
        squared = self.dot(self)
        return self.conjugated() / squared if squared > 0.0 else self.copy()

    def invert(self) -> None:
        """Become the inverse."""
        self._assign(self.inverted()._items)

    def normalized(self) -> Quaternion:
        """The unit quaternion of this rotation; the null quaternion stays null."""
        magnitude = self.magnitude
        return self / magnitude if magnitude > 0.0 else self.copy()

    def normalize(self) -> None:
        """Make the norm 1."""
        self._assign(self.normalized()._items)

    def negate(self) -> None:
        """Negate all components: the same rotation."""
        self._assign([-a for a in self._items])

    def identity(self) -> None:
        """Become no rotation."""
        self._assign([1.0, 0.0, 0.0, 0.0])

    # rotation ------------------------------------------------------------------------------------

    def slerp(self, other: Iterable[float], factor: float) -> Quaternion:
        """The rotation at `factor` (0 to 1) of the shorter way to another.

        K. Shoemake, "Animating rotation with quaternion curves", SIGGRAPH 1985.
        """
        if not 0.0 <= factor <= 1.0:
            raise ValueError(f"Quaternion.slerp: the factor lies between 0 and 1, given {factor!r}")
        a, b = self.normalized(), _quaternion(other).normalized()
        if a.dot(b) < 0.0:
            b = -b
        angle = 2.0 * atan2((a - b).magnitude, (a + b).magnitude)
        if angle < 1e-9:
            return (a * (1.0 - factor) + b * factor).normalized()
        return a * (sin((1.0 - factor) * angle) / sin(angle)) + b * (sin(factor * angle) / sin(angle))

    def rotate(self, other: Euler | Quaternion | Matrix) -> None:
        """Turn by another rotation, about the fixed axes; the norm stays."""
        turn = other if isinstance(other, Quaternion) else other.to_quaternion()
        self._assign(turn.normalized().cross(self)._items)

    def rotation_difference(self, other: Iterable[float]) -> Quaternion:
        """The quaternion d with ``self * d == other``."""
        return self.inverted().cross(other)

    @property
    def angle(self) -> float:
        """Angle of the rotation in radians, -pi to pi; assigning to it keeps the axis."""
        return _wrapped(2.0 * acos(max(-1.0, min(1.0, self.normalized().w))))

    @angle.setter
    def angle(self, angle: float) -> None:
        self._assign([a * self.magnitude for a in _about(list(self.axis), angle)])

    @property
    def axis(self) -> Vector:
        """Unit vector along the axis of the rotation, (1, 0, 0) if it turns nothing."""
        axis = Vector._wrap(list(self._items[1:])).normalized()
        return axis if axis.length > 0.0 else Vector((1.0, 0.0, 0.0))

    @axis.setter
    def axis(self, axis: Iterable[float]) -> None:
        row = floats(axis, "Quaternion.axis", 3, 3)
        self._assign([a * self.magnitude for a in _about(row, self.to_axis_angle()[1])])

    def to_axis_angle(self) -> tuple[Vector, float]:
        """Unit axis and angle in radians, 0 to 2 pi; axis (1, 0, 0) if the angle is 0."""
        w, x, y, z = self._items
        return self.axis, 2.0 * atan2(sqrt(x * x + y * y + z * z), w)

    def to_exponential_map(self) -> Vector:
        """The axis times the angle, the shorter way round."""
        axis, angle = (self if self.w >= 0.0 else -self).to_axis_angle()
        return axis * angle

    def as_rotation(self) -> rotations.Rotation9:
        """The rotation matrix, row by row, whatever the norm."""
        w, x, y, z = self.normalized()._items
        return rotations.rotation_from_quaternion(w, x, y, z)

    def to_matrix(self) -> Matrix:
        """3x3 rotation matrix."""
        return matrices.Matrix._wrap(rotations.rows_of(self.as_rotation()))

    def to_euler(self, order: str = "XYZ", compatible: Iterable[float] | None = None) -> Euler:
        """Euler angles in the given order, near to those of `compatible` if given."""
        return self.to_matrix().to_euler(order, compatible)

    def to_quaternion(self) -> Quaternion:
        """A copy."""
        return self.copy()

    def make_compatible(self, other: Iterable[float]) -> None:
        """Take the sign that is nearer to another quaternion."""
        if self.dot(other) < 0.0:
            self.negate()


def _quaternion(values: Iterable[float]) -> Quaternion:
    return values if isinstance(values, Quaternion) else Quaternion(floats(values, "Quaternion", 4, 4))


def _wrapped(angle: float) -> float:
    return angle - 2.0 * pi * round(angle / (2.0 * pi))


def _about(axis: list[float], angle: float) -> list[float]:
    x, y, z = axis
    length = sqrt(x * x + y * y + z * z)
    if length == 0.0:
        return [1.0, 0.0, 0.0, 0.0]
    half = _wrapped(angle) / 2.0
    scale = sin(half) / length
    return [cos(half), x * scale, y * scale, z * scale]
