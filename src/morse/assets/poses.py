"""Poses of nodes whose parent changes."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from morse.mathutils import Matrix
    from morse.scene import Node


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
