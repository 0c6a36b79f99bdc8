"""Vectors, quaternions and Euler angles, and conversions between them."""

from __future__ import annotations

from math import acos, atan2, sqrt
from typing import TYPE_CHECKING, Any, ClassVar, Self, SupportsFloat, overload

from morse.mathutils import matrix as matrices
from morse.mathutils import rotations, tracking
from morse.mathutils.quaternion_algebra import QuaternionAlgebra, about, wrapped
from morse.mathutils.sequence import FloatSequence, floats, is_number, rounded
from morse.mathutils.vector_algebra import VectorAlgebra

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from morse.mathutils.matrix import Matrix


class Vector(VectorAlgebra):
    """A vector of two to four floats; ``Vector()`` is (0, 0, 0).

    ``v * 2`` and ``2 * v`` scale; ``v * other`` and ``v @ other`` are the dot product; ``matrix * v`` and ``quaternion
    * v`` transform; ``v * matrix`` treats `v` as a row.
    """

    __slots__ = ()

    def rotate(self, other: Euler | Quaternion | Matrix) -> None:
        """Rotate this 3-vector in place."""
        if len(self._items) != 3:
            raise ValueError(f"Vector.rotate: needs 3 components, given {len(self._items)}")
        a, b, c, d, e, f, g, h, i = other.as_rotation()
        x, y, z = self._items
        self._assign([a * x + b * y + c * z, d * x + e * y + f * z, g * x + h * y + i * z])

    def rotation_difference(self, other: Iterable[float]) -> Quaternion:
        """Return the shortest rotation from this direction to another."""
        return Quaternion._wrap(list(tracking.shortest_arc(self, self._operand(other, "rotation_difference"))))

    def to_track_quat(self, track: str = "Z", up: str = "Y") -> Quaternion:
        """Return a rotation that points an axis (``X``, ``-Y`` …) along this vector, and another one upward."""
        return Quaternion._wrap(list(tracking.track_rotation(self, track, up)))


class Quaternion(QuaternionAlgebra):
    """A quaternion w, x, y, z; ``Quaternion()`` is the identity.

    ``Quaternion((w, x, y, z))``, ``Quaternion((x, y, z), angle)`` from an axis and radians, or ``Quaternion((x, y,
    z))`` from an exponential map: the axis times the angle. ``a * b`` and ``a @ b`` are the Hamilton product, ``q * v``
    rotates a 3-vector.
    """

    __slots__ = ()

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
    def __matmul__(self, other: object) -> Any:
        if isinstance(other, (Quaternion, Vector)):
            return self * other
        return NotImplemented

    def _turned(self, vector: Vector) -> Vector:
        if len(vector) != 3:
            raise ValueError(f"a Quaternion rotates vectors of 3 components, given {len(vector)}")
        w, x, y, z = self._items
        vx, vy, vz = vector
        tx, ty, tz = 2 * (y * vz - z * vy), 2 * (z * vx - x * vz), 2 * (x * vy - y * vx)
        return Vector._wrap(
            [vx + w * tx + y * tz - z * ty, vy + w * ty + z * tx - x * tz, vz + w * tz + x * ty - y * tx]
        )

    def rotate(self, other: Euler | Quaternion | Matrix) -> None:
        """Apply another rotation, about the fixed axes; the norm does not change."""
        turn = other if isinstance(other, Quaternion) else other.to_quaternion()
        self._assign(turn.normalized().cross(self)._items)

    @property
    def angle(self) -> float:
        """Angle of the rotation in radians, -pi to pi; assigning to it keeps the axis."""
        return wrapped(2.0 * acos(max(-1.0, min(1.0, self.normalized().w))))

    @angle.setter
    def angle(self, angle: float) -> None:
        self._assign([a * self.magnitude for a in about(list(self.axis), angle)])

    @property
    def axis(self) -> Vector:
        """Unit vector along the axis of the rotation; (1, 0, 0) if the angle is 0."""
        axis = Vector._wrap(list(self._items[1:])).normalized()
        return axis if axis.length > 0.0 else Vector((1.0, 0.0, 0.0))

    @axis.setter
    def axis(self, axis: Iterable[float]) -> None:
        row = floats(axis, "Quaternion.axis", 3, 3)
        self._assign([a * self.magnitude for a in about(row, self.to_axis_angle()[1])])

    def to_axis_angle(self) -> tuple[Vector, float]:
        """Return the unit axis, and the angle in radians, 0 to 2 pi; the axis is (1, 0, 0) if the angle is 0."""
        w, x, y, z = self._items
        return self.axis, 2.0 * atan2(sqrt(x * x + y * y + z * z), w)

    def to_exponential_map(self) -> Vector:
        """Return the axis times the angle, for the shorter direction."""
        axis, angle = (self if self.w >= 0.0 else -self).to_axis_angle()
        return axis * angle

    def as_rotation(self) -> rotations.Rotation9:
        """Return the rotation matrix, row by row, for any norm."""
        w, x, y, z = self.normalized()._items
        return rotations.rotation_from_quaternion(w, x, y, z)

    def to_matrix(self) -> Matrix:
        """Return the 3x3 rotation matrix."""
        return matrices.Matrix._wrap(rotations.rows_of(self.as_rotation()))

    def to_euler(self, order: str = "XYZ", compatible: Iterable[float] | None = None) -> Euler:
        """Return Euler angles in the given order; the closest ones to `compatible` if given."""
        return self.to_matrix().to_euler(order, compatible)

    def to_quaternion(self) -> Quaternion:
        """Return a copy."""
        return self.copy()


class Euler(FloatSequence):
    """Angles x, y, z in radians about fixed axes, applied in `order`: ``XYZ`` is ``Rz @ Ry @ Rx``.

    With ``XYZ`` x is roll, y pitch and z yaw.
    """

    __slots__ = ("_order",)
    _sizes: ClassVar[tuple[int, int]] = (3, 3)
    _order: str

    def __init__(self, angles: Iterable[SupportsFloat] = (0.0, 0.0, 0.0), order: str = "XYZ") -> None:
        self._items = floats(angles, "Euler", 3, 3)
        self.order = order

    @property
    def order(self) -> str:
        """The order of the rotations, first to last."""
        return self._order

    @order.setter
    def order(self, order: str) -> None:
        self._order = rotations.checked_order(order)

    def __repr__(self) -> str:
        return f"Euler(({', '.join(map(rounded, self._items))}), '{self._order}')"

    @property
    def x(self) -> float:
        """Angle about X."""
        return self._items[0]

    @x.setter
    def x(self, value: float) -> None:
        self[0] = value

    @property
    def y(self) -> float:
        """Angle about Y."""
        return self._items[1]

    @y.setter
    def y(self, value: float) -> None:
        self[1] = value

    @property
    def z(self) -> float:
        """Angle about Z."""
        return self._items[2]

    @z.setter
    def z(self, value: float) -> None:
        self[2] = value

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Euler):
            return NotImplemented
        return self._order == other._order and list(self._items) == list(other._items)

    __hash__ = FloatSequence.__hash__

    def as_rotation(self) -> rotations.Rotation9:
        """Return the rotation matrix, row by row."""
        return rotations.rotation_from_euler(self._items, self._order)

    def to_matrix(self) -> Matrix:
        """Return the 3x3 rotation matrix."""
        return matrices.Matrix._wrap(rotations.rows_of(self.as_rotation()))

    def to_quaternion(self) -> Quaternion:
        """Return the same rotation as a unit quaternion with w >= 0."""
        return Quaternion._wrap(list(rotations.quaternion_from_rotation(self.as_rotation())))

    def rotate(self, other: Euler | Quaternion | Matrix) -> None:
        """Apply another rotation, about the fixed axes."""
        rotation = rotations.product(other.as_rotation(), self.as_rotation())
        self._assign(rotations.compatible_euler(rotation, self._order, self._items))

    def rotate_axis(self, axis: str, angle: float) -> None:
        """Rotate by an angle (radians) about one of the own axes: ``X``, ``Y`` or ``Z``."""
        if axis not in ("X", "Y", "Z"):
            raise ValueError(f"Euler.rotate_axis: the axis is 'X', 'Y' or 'Z', given {axis!r}")
        own = [0.0, 0.0, 0.0]
        own["XYZ".index(axis)] = angle
        rotation = rotations.product(self.as_rotation(), rotations.rotation_from_euler(own, "XYZ"))
        self._assign(rotations.compatible_euler(rotation, self._order, self._items))

    def make_compatible(self, other: Iterable[float]) -> None:
        """Add whole turns, so that each angle differs by at most half a turn from that of another Euler."""
        self._assign(rotations.unwrapped(self._items, floats(other, "Euler.make_compatible", 3, 3)))

    def zero(self) -> None:
        """Set all angles to 0."""
        self._assign([0.0, 0.0, 0.0])

    def copy(self) -> Self:
        """Return a copy that is not frozen."""
        euler = self._wrap(list(self._items))
        euler._order = self._order
        return euler

    __copy__ = copy

    def __reduce__(self) -> tuple[Callable[..., object], tuple[object, ...]]:
        return type(self), (tuple(self._items), self._order)


Vector._plain = Vector  # type: ignore[misc]
Quaternion._plain = Quaternion  # type: ignore[misc]
