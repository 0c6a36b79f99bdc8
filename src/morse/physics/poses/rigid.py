"""Rigid transforms: on plain floats (positions of 3, rotations of 9 numbers, row-major), and poses of nodes as arrays.

For single poses these functions are several times faster than arrays, and every component needs its pose in every tick.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple, Protocol
from weakref import WeakKeyDictionary

import numpy as np

from morse.mathutils.portable import matmul
from morse.mathutils.rotations import cross as cross
from morse.mathutils.rotations import product as product
from morse.mathutils.rotations import turn as turn
from morse.mathutils.rotations import turn_back as turn_back
from morse.scene.frames import rigid_frame

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import NDArray

    from morse.scene import Node
    from morse.scene.frames import RigidFrame


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


def as_array(matrix: Iterable[Iterable[float]]) -> NDArray[np.float64]:
    """Convert a matrix to an array (R, C)."""
    return np.array([list(row) for row in matrix], dtype=np.float64)


#: for each node the two frames of the last call, and the result: whenever an object is spawned or deleted, the poses of
#: all other nodes are asked for again
_known: WeakKeyDictionary[Node, tuple[RigidFrame, RigidFrame, NDArray[np.float64], NDArray[np.float64]]] = (
    WeakKeyDictionary()
)


def relative_pose(node: Node, frame: RigidFrame) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the position (3,) and rotation (3, 3) of a node in a frame; the arrays are read-only."""
    own = rigid_frame(node)
    entry = _known.get(node)
    if entry is not None and entry[0] is own and entry[1] is frame:
        return entry[2], entry[3]
    inverse = as_array(frame.rotation).T
    position = matmul(inverse, np.array(own.position) - np.array(frame.position))
    rotation = matmul(inverse, as_array(own.rotation))
    position.flags.writeable = rotation.flags.writeable = False
    _known[node] = own, frame, position, rotation
    return position, rotation


_ORIGIN = (0.0, 0.0, 0.0)


class Mounted(Protocol):
    """An object in a rigid group; see `morse.physics.objects.gameobject.GameObject`."""

    slot: int
    mounting: Mounting


class Mounting(NamedTuple):
    """A pose in a rigid group.

    Most components have the orientation of their robots, and many are at its origin. Their poses are faster to compute.

    Attributes:
        offset: position, m.
        turned: 9 numbers of the rotation, row by row.
        is_apart: whether the pose differs from the pose of the group.
        is_turned: whether the rotation differs from the rotation of the group.
    """

    offset: Sequence[float]
    turned: Sequence[float]
    is_apart: bool
    is_turned: bool

    @classmethod
    def of(cls, pose: tuple[Sequence[float], Sequence[float]] | None) -> Mounting:
        """Create a mounting from a pose in the group; None for the pose of the group itself."""
        if pose is not None:
            is_turned = _differ(pose[1], IDENTITY)
            if is_turned or _differ(pose[0], _ORIGIN):
                return cls(*pose, True, is_turned)
        return cls(_ORIGIN, IDENTITY, False, False)

    def carried(self, position: Sequence[float], rotation: Sequence[float]) -> tuple[Sequence[float], Sequence[float]]:
        """Return the pose in the world, given the pose of the group."""
        if not self.is_apart:
            return position, rotation
        if self.is_turned:
            return compose(position, rotation, self.offset, self.turned)
        x, y, z = turn(rotation, self.offset)
        return (position[0] + x, position[1] + y, position[2] + z), rotation


def _differ(a: Sequence[float], b: Sequence[float]) -> bool:
    # a loop takes half the time of a generator
    for x, y in zip(a, b, strict=True):  # noqa: SIM110
        if not -1e-14 <= x - y <= 1e-14:
            return True
    return False
