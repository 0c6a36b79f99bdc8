"""Poses of objects, as sensors and actuators read them."""

from __future__ import annotations

from math import asin, atan2, dist
from typing import TYPE_CHECKING, Protocol

from morse.mathutils import Euler, Matrix, Quaternion, Vector
from morse.mathutils.rotations import Rotation9, both_eulers, nine, product, rows_of

if TYPE_CHECKING:
    from collections.abc import Sequence

_IDENTITY: Rotation9 = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)
_LOCKED = 1.0 - 1e-13  # sine of a pitch at which yaw and roll turn about one axis


class Posed(Protocol):
    """What has a pose: at least these two. An object with ``world_pose()`` is read faster: see `update`."""

    @property
    def worldPosition(self) -> Sequence[float]:  # noqa: N802 (the name user components know)
        """Position in the world frame, metres."""

    @property
    def worldOrientation(self) -> Sequence[Sequence[float]]:  # noqa: N802
        """3x3 rotation from the object's frame to the world."""


class Transformation3d:
    """A pose at one instant: X forward, Y left, Z up; metres and radians; rotation from the object to the world.

    A pose is taken once a tick by every component, of which most need little: only the numbers are kept,
    and angles and matrices are worked out when they are read. What is returned is the caller's own.
    """

    __slots__ = ("_position", "_rotation")
    _position: Sequence[float]
    _rotation: Sequence[float]

    def __init__(self, obj: Posed | None = None) -> None:
        """The pose of an object, or no displacement at all."""
        self._position = (0.0, 0.0, 0.0)
        self._rotation = _IDENTITY
        if obj is not None:
            self.update(obj)

    def update(self, obj: Posed) -> None:
        """Take the present pose of an object.

        An object may have a method ``world_pose()`` that returns the arguments of `set_pose`: that spares
        making a vector and a matrix.
        """
        try:
            world_pose = obj.world_pose  # type: ignore[attr-defined]
        except AttributeError:
            world_pose = None
        if world_pose is not None:
            self._position, self._rotation = world_pose()
        else:
            x, y, z = obj.worldPosition
            self._position, self._rotation = (x, y, z), nine(obj.worldOrientation)

    def set_pose(self, position: Sequence[float], rotation: Sequence[float]) -> None:
        """Take a pose as numbers. Both are kept as they are: they must not change afterwards.

        Args:
            position: 3 floats, metres.
            rotation: 9 floats, the rotation matrix row by row.
        """
        self._position = position
        self._rotation = rotation

    def numbers(self) -> tuple[float, float, float, float, float, float]:
        """x, y, z, yaw, pitch and roll at once, for those who need them all."""
        x, y, z = self._position
        m = self._rotation
        sine = m[6]
        if -_LOCKED < sine < _LOCKED:
            return x, y, z, atan2(m[3], m[0]), -asin(sine), atan2(m[7], m[8])
        return x, y, z, self.yaw, self.pitch, self.roll

    @property
    def x(self) -> float:
        """Metres along world X."""
        return self._position[0]

    @property
    def y(self) -> float:
        """Metres along world Y."""
        return self._position[1]

    @property
    def z(self) -> float:
        """Metres along world Z."""
        return self._position[2]

    @property
    def yaw(self) -> float:
        """Rotation about world Z, -pi to pi."""
        m = self._rotation
        if -_LOCKED < m[6] < _LOCKED:
            return atan2(m[3], m[0])
        return self._angles()[2]

    @property
    def pitch(self) -> float:
        """Rotation about the horizontal left axis, -pi/2 to pi/2, positive nose down."""
        sine = self._rotation[6]
        return -asin(sine) if -1.0 <= sine <= 1.0 else self._angles()[1]

    @property
    def roll(self) -> float:
        """Rotation about the own forward axis, -pi to pi."""
        m = self._rotation
        if -_LOCKED < m[6] < _LOCKED:
            return atan2(m[7], m[8])
        return self._angles()[0]

    def _angles(self) -> tuple[float, float, float]:
        return both_eulers(self._nine(), "XYZ")[0]

    def _nine(self) -> Rotation9:
        a, b, c, d, e, f, g, h, i = self._rotation
        return a, b, c, d, e, f, g, h, i

    @property
    def euler(self) -> Euler:
        """Roll, pitch and yaw as x, y and z."""
        return Euler((self.roll, self.pitch, self.yaw))

    @property
    def translation(self) -> Vector:
        """The position."""
        return Vector(self._position)

    @property
    def rotation(self) -> Quaternion:
        """The rotation as a unit quaternion with w >= 0."""
        return self.rotation_matrix.to_quaternion()

    @property
    def rotation_matrix(self) -> Matrix:
        """The 3x3 rotation matrix."""
        return Matrix(rows_of(self._nine()))

    @property
    def matrix(self) -> Matrix:
        """The 4x4 matrix from the object's frame to the world."""
        rows = rows_of(self._nine())
        return Matrix([*([*row, moved] for row, moved in zip(rows, self._position, strict=True)), (0.0, 0.0, 0.0, 1.0)])

    def distance(self, other: Transformation3d) -> float:
        """Metres between the two positions."""
        return dist(self._position, other._position)

    def distance_2d(self, other: Transformation3d) -> float:
        """Metres between the two positions seen from above."""
        return dist(self._position[:2], other._position[:2])

    def transformation3d_with(self, other: Transformation3d) -> Transformation3d:
        """The pose of another in the frame of this one: the inverse of this times the other."""
        a, b, c, d, e, f, g, h, i = self._rotation
        x, y, z = (q - p for p, q in zip(self._position, other._position, strict=True))
        made = Transformation3d()
        made.set_pose(
            (a * x + d * y + g * z, b * x + e * y + h * z, c * x + f * y + i * z),
            product((a, d, g, b, e, h, c, f, i), other._nine()),
        )
        return made

    def __repr__(self) -> str:
        return (
            f"Transformation3d(x={self.x:.4f}, y={self.y:.4f}, z={self.z:.4f}, "
            f"yaw={self.yaw:.4f}, pitch={self.pitch:.4f}, roll={self.roll:.4f})"
        )
