"""The space that the meshes of nodes occupy."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from morse.mathutils.portable import matmul
from morse.scene.frames import rigid_frame

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import NDArray

    from morse.scene.node import Node

Corners = tuple["NDArray[np.float64]", "NDArray[np.float64]"]


def extent(nodes: Iterable[Node], frame: Node | None = None) -> Corners | None:
    """Return the lower and the upper corner (3,) of the box around all vertices of nodes, m; None without vertices.

    Args:
        frame: the node whose frame is used for the corners; None for the world.
    """
    into = np.eye(4)
    if frame is not None:
        # without the scale of the frame, so that the unit is still the metre
        rigid = rigid_frame(frame)
        into[:3, :3] = np.array([list(row) for row in rigid.rotation]).T
        into[:3, 3] = matmul(-into[:3, :3], np.array(list(rigid.position)))
    low, high = np.full(3, np.inf), np.full(3, -np.inf)
    for node in nodes:
        if node.mesh is None or len(node.mesh.vertices) == 0:
            continue
        matrix = matmul(into, np.array([list(row) for row in node.world_matrix()]))
        points = matmul(node.mesh.vertices, matrix[:3, :3].T) + matrix[:3, 3]
        low, high = np.minimum(low, points.min(axis=0)), np.maximum(high, points.max(axis=0))
    return (low, high) if np.isfinite(low).all() else None


def visible_extent(root: Node) -> Corners | None:
    """Return the corners of the box around the visible meshes of a tree of nodes, see `extent`."""
    return extent(node for node in root.walk() if node.visible)
