"""Rotations found from directions."""

from __future__ import annotations

from morse.mathutils.matrix import Matrix
from morse.mathutils.quaternion import Quaternion
from morse.mathutils.vector import Vector

_AXES = ("X", "Y", "Z", "-X", "-Y", "-Z")


def shortest_arc(start: Vector, end: Vector) -> Quaternion:
    """The shortest rotation from one direction to another; about any axis at right angles if they are opposite."""
    a, b = start.to_3d().normalized(), end.to_3d().normalized()
    if not a.length or not b.length:
        return Quaternion()
    axis = a.cross(b)
    w = 1.0 + a.dot(b)
    if w < 1e-14 and axis.length < 1e-7:
        x, y, z = a.orthogonal().normalized()
        return Quaternion((0.0, x, y, z))
    return Quaternion((w, *axis)).normalized()


def track_rotation(direction: Vector, track: str, up: str) -> Quaternion:
    """Rotation with the axis `track` along a direction and the axis `up` as near to world Z as it can be.

    Raises:
        ValueError: the axes are unknown or lie along the same line.
    """
    if track not in _AXES or up not in _AXES[:3] or track[-1] == up:
        raise ValueError(
            f"to_track_quat: track is one of {', '.join(_AXES)} and up another of X, Y, Z; given {track!r} and {up!r}"
        )
    forward = direction.to_3d().normalized()
    if not forward.length:
        return Quaternion()
    track_index, up_index = "XYZ".index(track[-1]), "XYZ".index(up)
    track_axis = -forward if track.startswith("-") else forward
    up_axis = Vector((0.0, 0.0, 1.0)) - forward * forward.z
    if up_axis.length < 1e-7:
        # Straight up or down: nothing to choose the roll by, so take the rotation that turns least.
        unit = Vector((0.0, 0.0, 0.0))
        unit[track_index] = 1.0
        return shortest_arc(unit, track_axis)
    axes = [Vector(), Vector(), Vector()]
    axes[track_index], axes[up_index] = track_axis, up_axis.normalized()
    third = 3 - track_index - up_index
    axes[third] = axes[(third + 1) % 3].cross(axes[(third + 2) % 3])
    return Matrix([[axis[row] for axis in axes] for row in range(3)]).to_quaternion()
