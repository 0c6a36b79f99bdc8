"""Rigid transforms on plain floats: positions of 3, rotations of 9 (row-major) numbers.

For single poses these functions are several times faster than arrays, and every component needs its pose in every tick.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from morse.mathutils.rotations import cross as cross
from morse.mathutils.rotations import product as product
from morse.mathutils.rotations import turn as turn
from morse.mathutils.rotations import turn_back as turn_back

Position = Sequence[float]
Rotation = Sequence[float]

IDENTITY: tuple[float, ...] = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)


def transpose(r: Rotation) -> tuple[float, ...]:
    """Return ``R^T``."""
    return (r[0], r[3], r[6], r[1], r[4], r[7], r[2], r[5], r[8])


def compose(
    p: Position, r: Rotation, offset: Position, rotation: Rotation
) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Return the world pose of ``(offset, turned)``, which is given in the frame ``(p, r)``."""
    x, y, z = turn(r, offset)
    return (p[0] + x, p[1] + y, p[2] + z), product(r, rotation)


def relative(
    p: Position, r: Rotation, position: Position, rotation: Rotation
) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Return the world pose ``(position, rotation)`` in the frame ``(p, r)``."""
    delta = (position[0] - p[0], position[1] - p[1], position[2] - p[2])
    return turn_back(r, delta), product(transpose(r), rotation)


def rotation_of_vector(v: Position) -> tuple[float, ...]:
    """Return the rotation by ``|v|`` radians about ``v`` (Rodrigues)."""
    x, y, z = v
    angle = math.sqrt(x * x + y * y + z * z)
    if angle < 1e-12:
        return (1.0, -z, y, z, 1.0, -x, -y, x, 1.0)
    x, y, z = x / angle, y / angle, z / angle
    c, s = math.cos(angle), math.sin(angle)
    t = 1.0 - c
    return (
        t * x * x + c, t * x * y - s * z, t * x * z + s * y,
        t * x * y + s * z, t * y * y + c, t * y * z - s * x,
        t * x * z - s * y, t * y * z + s * x, t * z * z + c,
    )  # fmt: skip


def rotation_of_quaternion(q: Sequence[float]) -> tuple[float, ...]:
    """Return the rotation of a quaternion w, x, y, z, which is normalised first."""
    w, x, y, z = q
    n = math.sqrt(w * w + x * x + y * y + z * z) or 1.0
    w, x, y, z = w / n, x / n, y / n, z / n
    return (
        1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y),
        2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
        2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y),
    )  # fmt: skip


def quaternion(r: Sequence[float]) -> tuple[float, float, float, float]:
    """w, x, y, z of a rotation (Shepperd's method: the largest component first)."""
    trace = r[0] + r[4] + r[8]
    if trace > 0.0:
        s = 2.0 * math.sqrt(trace + 1.0)
        return 0.25 * s, (r[7] - r[5]) / s, (r[2] - r[6]) / s, (r[3] - r[1]) / s
    if r[0] > r[4] and r[0] > r[8]:
        s = 2.0 * math.sqrt(1.0 + r[0] - r[4] - r[8])
        return (r[7] - r[5]) / s, 0.25 * s, (r[1] + r[3]) / s, (r[2] + r[6]) / s
    if r[4] > r[8]:
        s = 2.0 * math.sqrt(1.0 + r[4] - r[0] - r[8])
        return (r[2] - r[6]) / s, (r[1] + r[3]) / s, 0.25 * s, (r[5] + r[7]) / s
    s = 2.0 * math.sqrt(1.0 + r[8] - r[0] - r[4])
    return (r[3] - r[1]) / s, (r[2] + r[6]) / s, (r[5] + r[7]) / s, 0.25 * s
