"""Triangle meshes that rays are cast at."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from morse.physics.rays.embree import TriangleScene, single

if TYPE_CHECKING:
    from numpy.typing import NDArray

#: the faces of a box by its corners (bit 0: +X, bit 1: +Y, bit 2: +Z), counter-clockwise from outside
BOX_TRIANGLES = np.array(
    [
        [0, 4, 6], [0, 6, 2], [1, 3, 7], [1, 7, 5],
        [0, 1, 5], [0, 5, 4], [2, 6, 7], [2, 7, 3],
        [0, 2, 3], [0, 3, 1], [4, 5, 7], [4, 7, 6],
    ],
    dtype=np.int32,
)  # fmt: skip
#: (8, 3) the corners of a cube of edge 2
BOX_CORNERS = np.array([[(i & 1) * 2 - 1, (i & 2) - 1, (i & 4) / 2 - 1] for i in range(8)], dtype=np.float64)


class Triangles:
    """A triangle mesh in a frame of its own.

    Attributes:
        vertices: (V, 3) metres.
        faces: (T, 3) indices of vertices; none without area.
        remissions: (T,) share of light that each triangle throws back, 0..1.
    """

    def __init__(
        self, vertices: NDArray[np.float64], faces: NDArray[np.int32], remissions: NDArray[np.float64]
    ) -> None:
        corners = vertices[faces]
        crosses = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        lengths = np.linalg.norm(crosses, axis=1)
        good = np.isfinite(lengths) & (lengths > 0.0)
        self.vertices = vertices
        self.faces = np.ascontiguousarray(faces[good], dtype=np.int32)
        self.remissions = remissions[good]
        self.normals = crosses[good] / lengths[good, None]
        self.offsets = np.einsum("ij,ij->i", self.normals, corners[good, 0])

    @property
    def box(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Centre (3,) and half sizes (3,) of the box around it."""
        used = self.vertices[self.faces].reshape(-1, 3)
        if not len(used):
            return np.zeros(3), np.zeros(3)
        low, high = used.min(axis=0), used.max(axis=0)
        return (low + high) / 2, (high - low) / 2

    @cached_property
    def scene(self) -> TriangleScene:
        """The triangles, ready for rays in their own frame, relative to the centre of their box."""
        return TriangleScene(self.vertices - self.box[0], self.faces)

    @cached_property
    def _middle(self) -> NDArray[np.float64]:
        return self.box[0]

    def first_surface(
        self, origins: NDArray[np.float64], directions: NDArray[np.float64], limits: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
        """Distance (N,), infinite for none, and triangle (N,) that each ray meets first, up to its limit."""
        if not len(self.faces):
            return np.full(len(origins), np.inf), np.full(len(origins), -1, dtype=np.int32)
        faces, rough = self.scene.cast(single(origins - self._middle), single(directions), single(limits))
        return on_plane(faces, rough, self.normals, self.offsets, origins, directions), faces


def on_plane(
    faces: NDArray[np.int32],
    rough: NDArray[np.floating[Any]],
    normals: NDArray[np.float64],
    offsets: NDArray[np.float64],
    origins: NDArray[np.float64],
    directions: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Distance (N,) to the planes of the triangles that single-precision rays have found.

    ``t = (d - n.o) / (n.r)``, in double precision. A ray that grazes a triangle may meet its plane
    far from it: there the rough distance stands. Infinite where the triangle is -1.
    """
    n = normals.take(faces, axis=0)
    exact = offsets.take(faces)
    exact -= np.einsum("ij,ij->i", n, origins)
    exact /= np.einsum("ij,ij->i", n, directions)
    # the negated comparison holds for NaN, too
    np.copyto(exact, rough, where=~(np.abs(exact - rough) <= 1e-3 * (1.0 + rough)))
    exact[faces < 0] = np.inf
    return exact
