"""Triangle meshes for ray casting."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from morse.kernel.rays import TriangleMesh

if TYPE_CHECKING:
    from numpy.typing import NDArray


class Triangles(TriangleMesh):
    """A triangle mesh with its own frame.

    Attributes:
        vertices: (V, 3) m.
        faces: (T, 3) indices of vertices; degenerate triangles are excluded.
        normals: (T, 3) unit vectors.
        remissions: (T,) reflectance of each triangle, 0..1.
    """

    def __init__(
        self, vertices: NDArray[np.float64], faces: NDArray[np.int32], remissions: NDArray[np.float64]
    ) -> None:
        corners = vertices[faces]
        crosses = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        lengths = np.linalg.norm(crosses, axis=1)
        good = np.isfinite(lengths) & (lengths > 0.0)
        super().__init__(vertices, np.ascontiguousarray(faces[good], dtype=np.int32))
        self.remissions = remissions[good]
        self.normals = crosses[good] / lengths[good, None]

    @property
    def box(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return the centre (3,) and half sizes (3,) of the bounding box, m."""
        corners = self.vertices[self.faces].reshape(-1, 3)
        if not len(corners):
            return np.zeros(3), np.zeros(3)
        low, high = corners.min(axis=0), corners.max(axis=0)
        return (low + high) / 2, (high - low) / 2
