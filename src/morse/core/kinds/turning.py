"""Quaternions (w, x, y, z), Euler angles and the frames of a component."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from morse.core.kinds.table import ORIENTATION, POINT
from morse.mathutils.rotations import (
    both_eulers,
    nine,
    product,
    quaternion_from_rotation,
    rotation_from_quaternion,
)

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from morse.core.object import Object
    from morse.core.values import Value
    from morse.mathutils.rotations import Quaternion4, Rotation9

#: frames between which the values of a component can always be converted
TURNABLE = ("own", "frd", "robot", "world", "earth", "ned_as_world")
#: the frame of magnetic fields in MORSE 1.4, which no message has
NED_AS_WORLD = "ned_as_world"
_SHORTEST = 1e-9


def quaternion_of(roll: float, pitch: float, yaw: float) -> Quaternion4:
    """The quaternion of a rotation about X by roll, then about Y by pitch, then about Z by yaw (fixed axes), rad."""
    a, b, c = 0.5 * roll, 0.5 * pitch, 0.5 * yaw
    cr, sr, cp, sp, cy, sy = math.cos(a), math.sin(a), math.cos(b), math.sin(b), math.cos(c), math.sin(c)
    w = cr * cp * cy + sr * sp * sy
    x, y, z = sr * cp * cy - cr * sp * sy, cr * sp * cy + sr * cp * sy, cr * cp * sy - sr * sp * cy
    return (w, x, y, z) if w >= 0.0 else (-w, -x, -y, -z)


def angles_of(quaternion: Sequence[float]) -> tuple[float, float, float]:
    """Roll, pitch and yaw, rad, of a quaternion of length 1."""
    w, x, y, z = quaternion
    return both_eulers(rotation_from_quaternion(w, x, y, z), "XYZ")[0]


def normalized(quaternion: Sequence[float]) -> tuple[float, ...] | None:
    """Return the quaternion scaled to length 1, or None if its length is 0, which means that no rotation is given.

    Raises:
        ValueError: a number is not finite.
    """
    length = math.hypot(*quaternion)
    if not math.isfinite(length):
        raise ValueError("a quaternion of finite numbers")
    return tuple(number / length for number in quaternion) if length > _SHORTEST else None


def turned(value: Value, moves: str, source_frame: str, target_frame: str, component: Object) -> Value:
    """Convert a value into another frame of its component.

    Args:
        value: (3,) or (..., 3) vector or point, or a quaternion.
        moves: ``vector``, ``point`` or ``orientation``.
        given, wanted: two frames of `TURNABLE`.
        component: the component, whose present pose is used.
    """
    import numpy as np

    from morse.mathutils.portable import matmul

    origin, rotation = _between(source_frame, target_frame, component)
    if moves == ORIENTATION:
        w, x, y, z = value
        return np.array(quaternion_from_rotation(product(rotation, rotation_from_quaternion(w, x, y, z))))
    result = matmul(np.asarray(value, dtype=np.float64), np.reshape(rotation, (3, 3)).T)
    return result + np.array(origin) if moves == POINT else result


def _between(source_frame: str, target_frame: str, component: Object) -> tuple[tuple[float, ...], Rotation9]:
    """Return the origin and rotation of the transformation from one frame into another."""
    (p, a), (q, b) = _pose(source_frame, component), _pose(target_frame, component)
    inverse = (b[0], b[3], b[6], b[1], b[4], b[7], b[2], b[5], b[8])
    x, y, z = (one - other for one, other in zip(p, q, strict=True))
    origin = tuple(inverse[i] * x + inverse[i + 1] * y + inverse[i + 2] * z for i in (0, 3, 6))
    return origin, product(inverse, a)


def _north_east_down(properties: Mapping[str, object]) -> Rotation9:
    """Return the rotation of the axes north, east and down in the world."""
    from morse.helpers.geodesy import angle_against_north

    angle = angle_against_north(properties)
    c, s = math.cos(angle), math.sin(angle)
    return (s, c, 0.0, c, -s, 0.0, 0.0, 0.0, -1.0)


def _pose(frame: str, component: Object) -> tuple[tuple[float, ...], Rotation9]:
    if frame == "world":
        return (0.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)
    if frame == "earth":
        from morse.helpers.geodesy import LocalPlane

        return LocalPlane.of(component.context.scene.properties).pose_of_earth()
    holder = component.robot_parent if frame == "robot" and component.robot_parent is not None else component
    pose = holder.position_3d
    rotation = nine(pose.rotation_matrix)  # type: ignore[arg-type] # a matrix is indexed likewise
    if frame == "frd":
        a, b, c, d, e, f, g, h, i = rotation
        rotation = (a, -b, -c, d, -e, -f, g, -h, -i)
    elif frame == NED_AS_WORLD:
        rotation = product(_north_east_down(component.context.scene.properties), rotation)
    return (pose.x, pose.y, pose.z), rotation
