"""Rigid frames of nodes, and poses of nodes whose parent changes."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING
from weakref import WeakKeyDictionary

from morse.mathutils import Matrix, Quaternion, Vector, rotations

if TYPE_CHECKING:
    from morse.scene.node import Node


@dataclass(frozen=True, slots=True)
class RigidFrame:
    """The pose of a node without scale.

    ``world_point = position + rotation @ (stretch @ mesh_point)``

    Attributes:
        position: metres, world frame.
        rotation: 3x3 proper rotation, node to world.
        stretch: 3x3 scale and shear (and mirroring) of the vertices of the mesh of the node.
    """

    position: Vector
    rotation: Matrix
    stretch: Matrix

    @property
    def quaternion(self) -> Quaternion:
        """The rotation as w, x, y, z."""
        return self.rotation.to_quaternion()


@dataclass(frozen=True, slots=True)
class _Known:
    """The frame of a node, and the numbers from which it was computed."""

    numbers: tuple[object, ...]
    parent: _Known | None
    world: Matrix
    frame: RigidFrame


#: frames of nodes: whenever an object is spawned or deleted, the frames of all other nodes are asked for again
_known_frames: WeakKeyDictionary[Node, _Known] = WeakKeyDictionary()


def rigid_frame(node: Node) -> RigidFrame:
    """The rigid frame of a node, from its world matrix.

    The rotation consists of the orthonormalised columns of the matrix, as in Blender. The frame is computed again only
    if the pose of the node or of a node above it has changed. It must not be modified.
    """
    chain = [node, *node.ancestors()]
    entry: _Known | None = None
    for one in reversed(chain):
        entry = _known(one, entry)
    assert entry is not None
    return entry.frame


def _known(node: Node, parent: _Known | None) -> _Known:
    inverse = node.parent_inverse
    numbers = (
        *node.location,
        *node.rotation_euler,
        *node.scale,
        None if inverse is None else tuple(tuple(row) for row in inverse),
    )
    entry = _known_frames.get(node)
    if entry is None or entry.parent is not parent or entry.numbers != numbers:
        local = node.local_matrix()
        world = local if parent is None else parent.world @ local
        entry = _known_frames[node] = _Known(numbers, parent, world, _frame_of(world))
    return entry


def _frame_of(world: Matrix) -> RigidFrame:
    # plain numbers are faster than vectors
    (a, b, c, px), (d, e, f, py), (g, h, i, pz) = (tuple(row) for row in world[:3])
    x0, x1, x2 = _unit(a, d, g, (1.0, 0.0, 0.0))
    along = b * x0 + e * x1 + h * x2
    fallback = (0.0, 1.0, 0.0) if abs(x1) < 0.9 else (0.0, 0.0, 1.0)
    y = y0, y1, y2 = _unit(b - x0 * along, e - x1 * along, h - x2 * along, fallback)
    along = y0 * x0 + y1 * x1 + y2 * x2
    y0, y1, y2 = _unit(y0 - x0 * along, y1 - x1 * along, y2 - x2 * along, y)
    z0, z1, z2 = x1 * y2 - x2 * y1, x2 * y0 - x0 * y2, x0 * y1 - x1 * y0
    stretch = rotations.product((x0, x1, x2, y0, y1, y2, z0, z1, z2), (a, b, c, d, e, f, g, h, i))
    return RigidFrame(
        Vector((px, py, pz)),
        Matrix(((x0, y0, z0), (x1, y1, z1), (x2, y2, z2))),
        Matrix(rotations.rows_of(stretch)),
    )


def _unit(x: float, y: float, z: float, fallback: tuple[float, float, float]) -> tuple[float, float, float]:
    length = math.hypot(x, y, z)
    if length <= 1e-12:
        return fallback
    scale = 1.0 / length
    return x * scale, y * scale, z * scale


def set_free(node: Node, world: Matrix | None = None) -> None:
    """Detach a node from its parent, at its present pose or at a given 4x4 pose in the world.

    Location, rotation and scale cannot represent the shear of a tree of scaled nodes, so shear is lost.
    """
    world = node.world_matrix() if world is None else world
    node.detach()
    location, rotation, scale = world.decompose()
    node.location = list(location)
    node.rotation_euler = list(rotation.to_euler())
    node.scale = list(scale)


def attach_in_place(parent: Node, child: Node) -> None:
    """Attach a node without moving it; if the parent has a scale of 0, its local pose is kept instead."""
    try:
        parent.attach(child, keep_world_pose=True)
    except ValueError:
        parent.attach(child)
