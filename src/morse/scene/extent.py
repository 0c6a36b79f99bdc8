"""The extent of what is drawn of an object."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from morse.mathutils.portable import matmul

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from morse.scene.node import Node


def extent(root: Node) -> tuple[NDArray[np.float64], NDArray[np.float64]] | None:
    """Return the lowest and the highest corner (3,) of the visible meshes of a tree of nodes, m; None without any."""
    points = []
    for node in root.walk():
        if node.mesh is not None and len(node.mesh.vertices) and node.visible:
            matrix = np.array([list(row) for row in node.world_matrix()])
            points.append(matmul(node.mesh.vertices, matrix[:3, :3].T) + matrix[:3, 3])
    if not points:
        return None
    corners = np.concatenate(points)
    return corners.min(axis=0), corners.max(axis=0)
