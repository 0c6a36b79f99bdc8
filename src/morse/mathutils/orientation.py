"""Vectors, quaternions and Euler angles, and conversions between them."""

from __future__ import annotations

from math import acos, atan2, cos, pi, sin, sqrt
from typing import TYPE_CHECKING, Any, ClassVar, Self, SupportsFloat, overload

from morse.mathutils import matrix as matrices
from morse.mathutils import rotations
from morse.mathutils.sequence import FloatSequence, VectorAlgebra, floats, is_number, rounded

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from morse.mathutils.matrix import Matrix
    from morse.mathutils.rotations import Quaternion4


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


_AXES = ("X", "Y", "Z", "-X", "-Y", "-Z")
_NONE = (1.0, 0.0, 0.0, 0.0)


def shortest_arc(start: VectorAlgebra, end: VectorAlgebra) -> Quaternion4:
    """Return the shortest rotation from one direction to another; about any perpendicular axis if they are opposite."""
    a, b = start.to_3d().normalized(), end.to_3d().normalized()
    if not a.length or not b.length:
        return _NONE
    axis = a.cross(b)
    w = 1.0 + a.dot(b)
    if w < 1e-14 and axis.length < 1e-7:
        x, y, z = a.orthogonal().normalized()
        return 0.0, x, y, z
    x, y, z = axis
    norm = sqrt(w * w + x * x + y * y + z * z)
    return w / norm, x / norm, y / norm, z / norm


def track_rotation(direction: VectorAlgebra, track: str, up: str) -> Quaternion4:
    """Return a rotation with the axis `track` along a direction and the axis `up` as close to world Z as possible.

    Raises:
        ValueError: the axes are unknown or are along the same line.
    """
    if track not in _AXES or up not in _AXES[:3] or track[-1] == up:
        raise ValueError(
            f"to_track_quat: track is one of {', '.join(_AXES)} and up another of X, Y, Z; given {track!r} and {up!r}"
        )
    forward = direction.to_3d().normalized()
    if not forward.length:
        return _NONE
    track_index, up_index = "XYZ".index(track[-1]), "XYZ".index(up)
    track_axis = -forward if track.startswith("-") else forward
    zero = forward * 0.0
    up_axis = zero.copy()
    up_axis.z = 1.0
    up_axis -= forward * forward.z
    if up_axis.length < 1e-7:
        # If the direction is vertical, the roll is undefined: use the rotation with the smallest angle.
        unit = zero.copy()
        unit[track_index] = 1.0
        return shortest_arc(unit, track_axis)
    axes = [zero, zero, zero]
    axes[track_index], axes[up_index] = track_axis, up_axis.normalized()
    third = 3 - track_index - up_index
    axes[third] = axes[(third + 1) % 3].cross(axes[(third + 2) % 3])
    rows = [[axis[row] for axis in axes] for row in range(3)]
    return rotations.quaternion_from_rotation(rotations.unscaled(rotations.nine(rows)))


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
        return Quaternion._wrap(list(shortest_arc(self, self._operand(other, "rotation_difference"))))

    def to_track_quat(self, track: str = "Z", up: str = "Y") -> Quaternion:
        """Return a rotation that points an axis (``X``, ``-Y`` …) along this vector, and another one upward."""
        return Quaternion._wrap(list(track_rotation(self, track, up)))


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
