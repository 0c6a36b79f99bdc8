"""The sizes of objects."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from morse.scene import Node


def extent(root: Node) -> list[float] | None:
    """Length along X, Y and Z of all visible meshes of a node and its descendants, m; None without meshes."""
    low, high = np.full(3, np.inf), np.full(3, -np.inf)
    for node in root.walk():
        if node.mesh is None or not node.visible or len(node.mesh.vertices) == 0:
            continue
        matrix = np.array([list(row) for row in node.world_matrix()])
        points = node.mesh.vertices @ matrix[:3, :3].T + matrix[:3, 3]
        low, high = np.minimum(low, points.min(axis=0)), np.maximum(high, points.max(axis=0))
    return [float(length) for length in high - low] if np.isfinite(low).all() else None
