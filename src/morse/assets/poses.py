"""Poses of nodes that change their place in the tree."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from morse.mathutils import Matrix
    from morse.scene import Node


def set_free(node: Node, world: Matrix | None = None) -> None:
    """Take a node from its parent, without moving it or to the given 4x4 pose in the world.

    Location, rotation and scale cannot say all that a tree of scaled nodes can: shear gets lost.
    """
    world = node.world_matrix() if world is None else world
    node.detach()
    location, rotation, scale = world.decompose()
    node.location = list(location)
    node.rotation_euler = list(rotation.to_euler())
    node.scale = list(scale)


def attach_in_place(parent: Node, child: Node) -> None:
    """Attach a node without moving it; to a parent that is flat in one direction, with the pose that it has."""
    try:
        parent.attach(child, keep_world_pose=True)
    except ValueError:
        parent.attach(child)
