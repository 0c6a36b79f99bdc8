"""Simplification of surfaces."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from morse.assets.shapes.surface import measured, open_edges, with_three_corners

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from morse.assets.shapes.surface import Surface

#: the cube of the number of vertices fits into 64 bits
_MOST_KEYS = 1 << 21


def coarsened(surface: Surface, cell: float, bends: NDArray[np.float64] | None = None) -> Surface:
    """Simplify a surface to one vertex per grid cell, the vertex where the surface bends most.

    J. Rossignac and P. Borrel, "Multi-resolution 3D approximations for rendering complex scenes" (1993).
    No vertex moves farther than the diagonal of a cell.

    Args:
        surface: the surface.
        cell: width of the cells, metres.
        bends: (V,) the `sharpness` of the surface, if it is simplified several times.
    """
    low = surface.vertices.min(axis=0)
    x, y, z = np.floor((surface.vertices - low) / cell).astype(np.int64).T
    key = (x << 42) + (y << 21) + z
    order = np.lexsort((-(sharpness(surface) if bends is None else bends), key))
    _, first, group = np.unique(key[order], return_index=True, return_inverse=True)
    representatives = np.empty(len(key), dtype=np.int64)
    representatives[order] = order[first][group.ravel()]
    faces = with_three_corners(representatives[surface.triangles])
    used_vertices, faces = np.unique(faces, return_inverse=True)
    faces = faces.reshape(-1, 3)
    a, b, c = np.sort(faces, axis=1).T
    if len(used_vertices) < _MOST_KEYS:
        _, once = np.unique((a * len(used_vertices) + b) * len(used_vertices) + c, return_index=True)
    else:
        _, once = np.unique(np.column_stack([a, b, c]), axis=0, return_index=True)
    return measured(surface.vertices[used_vertices], faces[once])


def sharpness(surface: Surface) -> NDArray[np.float64]:
    """(V,) 0 on flat areas, up to 1 where the normals of the faces differ most; 2 at the rim, up to 3 at corners."""
    weights = np.repeat(surface.areas, 3)
    total = np.bincount(surface.triangles.ravel(), weights=weights, minlength=len(surface.vertices))
    mean = _sums(surface, surface.triangles.ravel(), np.repeat(surface.normals, 3, axis=0) * weights[:, None])
    sharpness = 1.0 - np.linalg.norm(mean, axis=1) / np.maximum(total, 1e-300)
    starts, ends = open_edges(surface.triangles, len(surface.vertices))
    along = surface.vertices[ends] - surface.vertices[starts]
    along /= np.maximum(np.linalg.norm(along, axis=1), 1e-300)[:, None]
    straight = np.linalg.norm(_sums(surface, starts, along) + _sums(surface, ends, along), axis=1) / 2.0
    sharpness[starts] = 3.0 - straight[starts]
    # rounded, so that the choice of a vertex does not depend on the last bit
    bent: NDArray[np.float64] = np.round(sharpness, 9)
    return bent


def _sums(surface: Surface, vertices: NDArray[np.int64], vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    """(V, 3) sums of the vectors given to each vertex."""
    size = len(surface.vertices)
    return np.column_stack([np.bincount(vertices, weights=column, minlength=size) for column in vectors.T])
