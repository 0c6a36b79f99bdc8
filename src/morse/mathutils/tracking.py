"""Rotations from directions, as quaternions w, x, y, z."""

from __future__ import annotations

from math import sqrt
from typing import TYPE_CHECKING

from morse.mathutils import rotations

if TYPE_CHECKING:
    from morse.mathutils.rotations import Quaternion4
    from morse.mathutils.vector_algebra import VectorAlgebra

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
