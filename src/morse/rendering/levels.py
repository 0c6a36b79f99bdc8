"""Levels of detail: simplified copies of a mesh, for distances at which the difference is smaller than a pixel."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from morse.kernel.drawing import Simplification, simplify
from morse.mathutils.portable import norm
from morse.rendering.rows import different

if TYPE_CHECKING:
    from numpy.typing import NDArray

#: smallest number of triangles of a mesh that is simplified
_FEWEST = 64
#: the errors of the levels are the size of the mesh divided by these numbers
_SHARES = (256, 128, 64, 32, 16, 8)
#: a level has at most this share of the triangles of the level before
_LESS = 0.7


class Level(NamedTuple):
    """A simplified copy of a mesh.

    Attributes:
        error: bound of the distance between the copy and the mesh, m.
        rows: (T, 3, 8) float32, position, normal and texture coordinates of the corners.
        origin: (T,) the triangle of the mesh that each triangle replaces.
    """

    error: float
    rows: NDArray[np.float32]
    origin: NDArray[np.intp]


def levels_of(rows: NDArray[np.float32], slot: NDArray[np.integer], *, textured: bool) -> list[Level]:
    """Simplify a mesh, the finest level first; empty if the mesh has too few triangles.

    Each point of a copy is at most its error away from the mesh, and the other way round. Edges, closed parts and
    borders between materials remain closed.

    Args:
        rows: (T, 3, 8) float32, position, normal and texture coordinates of the corners.
        slot: (T,) material slot.
        textured: whether the texture coordinates are used.
    """
    levels: list[Level] = []
    if len(rows) < _FEWEST:
        return levels
    corners = rows.reshape(-1, 8)
    size = float(norm(np.ptp(corners[:, :3], axis=0).astype(np.float64)))
    if not size > 0.0:
        return levels
    mesh, places, looks = _mesh(corners, slot, textured=textured)
    count = len(rows)
    for share in _SHARES:
        limit = size / share
        remaining = simplify(mesh, limit)
        if remaining > _LESS * count or not remaining:
            continue
        count = remaining
        triangles = np.flatnonzero(mesh.alive)
        picked = np.concatenate([places[mesh.vertices[triangles]], looks[mesh.look[triangles]]], axis=2)
        levels.append(Level(float(mesh.errors[triangles].max()), picked, triangles))
        if count < _FEWEST:
            break
    return levels


def _mesh(
    corners: NDArray[np.float32], slot: NDArray[np.integer], *, textured: bool
) -> tuple[Simplification, NDArray[np.float32], NDArray[np.float32]]:
    """The mesh, and its different positions and attributes."""
    slots = np.repeat(slot, 3).astype(np.float32)
    # equal rows first, because positions and attributes repeat among the different ones only
    first, row = different(np.column_stack([corners, slots]))
    rows, slots = corners[first], slots[first]
    first, vertices = different(rows[:, :3])
    places = rows[first, :3]
    vertices = vertices[row]
    first, look = different(np.column_stack([rows[:, 3:], slots]))
    look, looks, slots = look[row], rows[first, 3:], slots[first]
    units = looks.astype(np.float64)
    square = units[:, 0] * units[:, 0] + units[:, 1] * units[:, 1] + units[:, 2] * units[:, 2]
    units[:, :3] /= np.sqrt(np.maximum(square, 1e-30))[:, None]
    index = vertices.reshape(-1, 3).astype(np.int32)
    a, b, c = index.T
    mesh = Simplification(
        points=places.astype(np.float64),
        looks=units,
        slots=slots.astype(np.int32),
        vertices=index,
        look=look.reshape(-1, 3).astype(np.int32),
        errors=np.zeros(len(index)),
        alive=((a != b) & (b != c) & (c != a)).astype(np.uint8),
        textured=textured,
    )
    return mesh, places, looks
