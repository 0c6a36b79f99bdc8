"""Axis-aligned boxes around collision shapes."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from morse.mathutils.portable import matmul
from morse.scene.shapes import ShapeKind

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from morse.scene.shapes import CollisionShape


def box_around(shape: CollisionShape, position: NDArray[np.float64], rotation: NDArray[np.float64]) -> tuple[
    NDArray[np.float64], NDArray[np.float64]
]:  # fmt: skip
    """Return the lower and the upper corner (3,), m, of the smallest box around a shape, along the axes of the world.

    Args:
        position, rotation: (3,) m, and (3, 3): pose of the node of the shape in the world.
    """
    if shape.kind is ShapeKind.CONVEX:
        assert shape.vertices is not None
        points = matmul(shape.vertices, rotation.T) + position
        return points.min(axis=0), points.max(axis=0)
    turn = matmul(rotation, np.reshape(shape.rotation, (3, 3)))
    centre = position + matmul(rotation, np.asarray(shape.position))
    size = np.asarray(shape.size)
    if shape.kind is ShapeKind.HEIGHT_FIELD:
        centre = centre + turn[:, 2] * (0.5 * (size[2] - size[3]))
        half = matmul(np.abs(turn), np.array([size[0], size[1], 0.5 * (size[2] + size[3])]))
    elif shape.kind is ShapeKind.BOX:
        half = matmul(np.abs(turn), size)
    elif shape.kind is ShapeKind.ELLIPSOID:
        half = np.sqrt(((turn * size) ** 2).sum(axis=1))
    elif shape.kind is ShapeKind.CYLINDER:
        along = np.abs(turn[:, 2])
        half = size[0] * np.sqrt(np.maximum(0.0, 1.0 - along**2)) + size[1] * along
    else:
        straight = size[1] if shape.kind is ShapeKind.CAPSULE else 0.0
        half = size[0] + straight * np.abs(turn[:, 2])
    return centre - half, centre + half
