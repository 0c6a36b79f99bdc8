"""A mesh that is simplified in steps."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


class Simplification(NamedTuple):
    """A mesh that is simplified: the last four arrays change.

    Attributes:
        points: (V, 3) float64, positions of the vertices, all different.
        looks: (A, 5) float64, unit normals and texture coordinates, all rows different.
        slots: (A,) int32, the material slot of each of these rows.
        vertices: (T, 3) int32, the vertices of the corners of triangles.
        look: (T, 3) int32, the row of `looks` of each corner.
        errors: (T,) float64, the bounds of the errors of triangles, m.
        alive: (T,) uint8, 1 for triangles that remain.
        textured: whether texture coordinates are used.
    """

    points: NDArray[np.float64]
    looks: NDArray[np.float64]
    slots: NDArray[np.int32]
    vertices: NDArray[np.int32]
    look: NDArray[np.int32]
    errors: NDArray[np.float64]
    alive: NDArray[np.uint8]
    textured: bool
