"""Poses of objects, as used by sensors and actuators."""

from __future__ import annotations

from math import asin, atan2, dist
from typing import TYPE_CHECKING, Any, Protocol

from morse.mathutils import Euler, Matrix, Quaternion, Vector
from morse.mathutils.rotations import Rotation9, euler_from_rotation, nine, product, rows_of

if TYPE_CHECKING:
    from collections.abc import Sequence

_IDENTITY: Rotation9 = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)
# If the own Z axis rises this steeply, |roll| + |pitch| is below 90 degrees (because cos(|roll| + |pitch|) >= 2
# cos(roll) cos(pitch) - 1). The solution with the smaller sum of angles is then the solution whose pitch is within 90
# degrees, whatever the yaw: its sum is s, and that of the other solution is 3 pi - s.
UPRIGHT = 0.51


class Posed(Protocol):
    """An object with a pose. Objects with ``world_pose()`` are read faster: see `update`."""

    @property
    def worldPosition(self) -> Any:  # noqa: N802 (the name user components know)
        """Position in the world frame, metres."""

    @property
    def worldOrientation(self) -> Any:  # noqa: N802
        """3x3 rotation from the object's frame to the world."""


class PoseSource(Protocol):
    """A source of poses that change over time."""

    @property
    def stamp(self) -> object:
        """A value that changes whenever the poses change."""

    def pose_of(self, row: int) -> tuple[Sequence[float], Sequence[float]]:
        """Return the arguments of `Transformation3d.set_pose`."""


def euler_angles(m: Sequence[float]) -> tuple[float, float, float]:
    """Return roll, pitch and yaw of a rotation, 9 numbers row by row; see `Transformation3d`."""
    if m[8] > UPRIGHT:
        return atan2(m[7], m[8]), -asin(m[6]), atan2(m[3], m[0])
    a, b, c, d, e, f, g, h, i = m
    return euler_from_rotation((a, b, c, d, e, f, g, h, i), "XYZ")


class Transformation3d:
    """A pose at one instant, m and rad; X forward, Y left, Z up; the rotation maps the object frame to the world.

    Two sets of yaw, pitch and roll describe the same rotation. As in Blender, the set with the smaller |yaw| + |pitch|
    + |roll| is used. The yaw and roll of a robot that only pitches are therefore 0, even if it is upside down.

    Every component updates its pose in each tick. Only the numbers are stored; angles and matrices are computed when
    they are read. Returned objects are copies.
    """

    __slots__ = ("_position", "_rotation")
    _position: Sequence[float]
    _rotation: Sequence[float]

    def __init__(self, obj: Posed | None = None) -> None:
        """Create the pose of an object, or the identity."""
        self._position = (0.0, 0.0, 0.0)
        self._rotation = _IDENTITY
        if obj is not None:
            self.update(obj)

    def update(self, obj: Posed) -> None:
        """Set the pose to the present pose of an object.

        An object may have a method ``world_pose()`` that returns the arguments of `set_pose`, which avoids creating a
        vector and a matrix.
        """
        try:
            world_pose = obj.world_pose  # type: ignore[attr-defined]
        except AttributeError:
            world_pose = None
        if world_pose is not None:
            position, rotation = world_pose()
        else:
            x, y, z = obj.worldPosition
            position, rotation = (x, y, z), nine(obj.worldOrientation)
        self.set_pose(position, rotation)

    def set_pose(self, position: Sequence[float], rotation: Sequence[float]) -> None:
        """Set the pose from numbers. The arguments are not copied and must not be modified afterwards.

        Args:
            position: 3 floats, m.
            rotation: 9 floats, the rotation matrix row by row.
        """
        self._position = position
        self._rotation = rotation

    def get_pose(self) -> tuple[Sequence[float], Sequence[float]]:
        """Return the arguments of `set_pose`; they must not be modified."""
        return self._position, self._rotation

    def numbers(self) -> tuple[float, float, float, float, float, float]:
        """Return x, y, z, yaw, pitch and roll in one call."""
        x, y, z = self._position
        roll, pitch, yaw = euler_angles(self._rotation)
        return x, y, z, yaw, pitch, roll

    @property
    def x(self) -> float:
        """Position along world X, m."""
        return self._position[0]

    @property
    def y(self) -> float:
        """Position along world Y, m."""
        return self._position[1]

    @property
    def z(self) -> float:
        """Position along world Z, m."""
        return self._position[2]

    @property
    def yaw(self) -> float:
        """Rotation about world Z, -pi to pi."""
        m = self._rotation
        return atan2(m[3], m[0]) if m[8] > UPRIGHT else self._angles()[2]

    @property
    def pitch(self) -> float:
        """Rotation about the horizontal left axis, -pi to pi, positive nose down."""
        m = self._rotation
        return -asin(m[6]) if m[8] > UPRIGHT else self._angles()[1]

    @property
    def roll(self) -> float:
        """Rotation about the forward axis of the object, -pi to pi."""
        m = self._rotation
        return atan2(m[7], m[8]) if m[8] > UPRIGHT else self._angles()[0]

    def _angles(self) -> tuple[float, float, float]:
        return euler_from_rotation(self._nine(), "XYZ")

    def _nine(self) -> Rotation9:
        a, b, c, d, e, f, g, h, i = self._rotation
        return a, b, c, d, e, f, g, h, i

    @property
    def euler(self) -> Euler:
        """Roll, pitch and yaw as x, y and z."""
        return Euler(self.numbers()[:2:-1])

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
        return Matrix(
            [
                *([*row, translation] for row, translation in zip(rows, self._position, strict=True)),
                (0.0, 0.0, 0.0, 1.0),
            ]
        )

    def distance(self, other: Transformation3d) -> float:
        """Return the distance between the two positions, m."""
        return dist(self._position, other._position)

    def distance_2d(self, other: Transformation3d) -> float:
        """Return the horizontal distance between the two positions, m."""
        return dist(self._position[:2], other._position[:2])

    def transformation3d_with(self, other: Transformation3d) -> Transformation3d:
        """Return another pose in the frame of this one: the inverse of this pose times the other."""
        a, b, c, d, e, f, g, h, i = self._rotation
        x, y, z = (q - p for p, q in zip(self._position, other._position, strict=True))
        transformation = Transformation3d()
        transformation.set_pose(
            (a * x + d * y + g * z, b * x + e * y + h * z, c * x + f * y + i * z),
            product((a, d, g, b, e, h, c, f, i), other._nine()),
        )
        return transformation

    def __repr__(self) -> str:
        return (
            f"Transformation3d(x={self.x:.4f}, y={self.y:.4f}, z={self.z:.4f}, "
            f"yaw={self.yaw:.4f}, pitch={self.pitch:.4f}, roll={self.roll:.4f})"
        )


class FollowingPose(Transformation3d):
    """A pose that may follow a source: reading it returns the present pose of the source.

    The effect of `update` and `set_pose` lasts until the stamp of the source changes.
    """

    __slots__ = ("_here", "_row", "_source", "_stamp", "_turn")

    def __init__(self, obj: Posed | None = None) -> None:
        self._source: PoseSource | None = None
        super().__init__(obj)

    def follow(self, source: PoseSource, row: int = 0) -> None:
        """Follow a row of a source, from the next change of its stamp on."""
        self._source, self._row = source, row
        self._stamp = source.stamp

    def stay(self) -> None:
        """Stop following, and keep the present pose."""
        self._refresh()
        self._source = None

    def _refresh(self) -> None:
        source = self._source
        if source is not None and source.stamp != self._stamp:
            position, rotation = source.pose_of(self._row)
            self.set_pose(position, rotation)

    def set_pose(self, position: Sequence[float], rotation: Sequence[float]) -> None:
        """See `Transformation3d.set_pose`."""
        self._here, self._turn = position, rotation
        if self._source is not None:
            self._stamp = self._source.stamp

    @property
    def _position(self) -> Sequence[float]:
        self._refresh()
        return self._here

    @_position.setter
    def _position(self, position: Sequence[float]) -> None:
        self._here = position

    @property
    def _rotation(self) -> Sequence[float]:
        self._refresh()
        return self._turn

    @_rotation.setter
    def _rotation(self, rotation: Sequence[float]) -> None:
        self._turn = rotation

    def __reduce_ex__(self, protocol: object) -> tuple[object, ...]:
        """A copy is the present pose and does not follow the source."""
        return _plain, (self._position, self._rotation)


def _plain(position: Sequence[float], rotation: Sequence[float]) -> Transformation3d:
    transformation = Transformation3d()
    transformation.set_pose(position, rotation)
    return transformation
