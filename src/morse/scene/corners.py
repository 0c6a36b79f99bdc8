"""The corners of collision shapes."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from morse.mathutils import portable
from morse.mathutils.portable import matmul
from morse.scene.shapes import ShapeKind

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from morse.scene.shapes import CollisionShape


def corners(shape: CollisionShape, position: NDArray[np.float64], rotation: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return points (P, 3) in the frame of a body whose convex hull is the shape (approximately, if it is round).

    Args:
        position, rotation: (3,) and (3, 3) pose of the node of the shape in that frame.
    """
    if shape.kind is ShapeKind.CONVEX:
        assert shape.vertices is not None
        return np.asarray(matmul(shape.vertices, rotation.T) + position)
    if shape.kind is ShapeKind.BOX:
        signs = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], dtype=np.float64)
        own = signs * np.asarray(shape.size)
    elif shape.kind is ShapeKind.CYLINDER:
        turn = np.arange(24) * (math.pi / 12)
        ring = np.column_stack([portable.cos(turn), portable.sin(turn)]) * shape.size[0]
        own = np.vstack([np.column_stack([ring, np.full(24, h)]) for h in (-shape.size[1], shape.size[1])])
    else:
        radius = shape.size[0]
        up = radius + (shape.size[1] if shape.kind is ShapeKind.CAPSULE else 0.0)
        own = np.array([[radius, 0, 0], [-radius, 0, 0], [0, radius, 0], [0, -radius, 0], [0, 0, up], [0, 0, -up]])
    shape_rotation = matmul(rotation, np.reshape(shape.rotation, (3, 3)))
    return np.asarray(matmul(own, shape_rotation.T) + position + matmul(rotation, np.asarray(shape.position)))
