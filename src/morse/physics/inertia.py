"""Mass properties of bodies."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from morse.scene import ShapeKind

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from morse.scene import CollisionShape

#: share of its height at which a driven robot carries its centre of mass: batteries and motors
#: sit low, and a robot described only by its hull must not topple at the first kerb
ROBOT_CENTRE_HEIGHT = 0.2


def volume(shape: CollisionShape) -> float:
    """Volume of a shape, m^3 (of the bounding box for a convex hull)."""
    s = shape.size
    match shape.kind:
        case ShapeKind.BOX:
            return 8 * s[0] * s[1] * s[2]
        case ShapeKind.SPHERE:
            return 4 / 3 * math.pi * s[0] ** 3
        case ShapeKind.ELLIPSOID:
            return 4 / 3 * math.pi * s[0] * s[1] * s[2]
        case ShapeKind.CYLINDER:
            return 2 * math.pi * s[0] ** 2 * s[1]
        case ShapeKind.CAPSULE:
            return 2 * math.pi * s[0] ** 2 * s[1] + 4 / 3 * math.pi * s[0] ** 3
        case ShapeKind.CONVEX:
            assert shape.vertices is not None
            return float(np.prod(np.maximum(np.ptp(shape.vertices, axis=0), 1e-3)))


def bounding_box(
    shape: CollisionShape, position: NDArray[np.float64], rotation: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Lower and upper corner (3,) of a shape whose node sits at a pose in the frame asked for."""
    if shape.kind is ShapeKind.CONVEX:
        assert shape.vertices is not None
        points = shape.vertices @ rotation.T + position
        return points.min(axis=0), points.max(axis=0)
    turned = rotation @ np.reshape(shape.rotation, (3, 3))
    centre = position + rotation @ np.asarray(shape.position)
    half = half_sizes(shape)
    extent = np.abs(turned) @ half if shape.kind is not ShapeKind.SPHERE else half
    return centre - extent, centre + extent


def half_sizes(shape: CollisionShape) -> NDArray[np.float64]:
    """Half sizes (3,) of the box around a primitive, in its own frame."""
    s = shape.size
    match shape.kind:
        case ShapeKind.SPHERE:
            return np.full(3, s[0])
        case ShapeKind.CYLINDER:
            return np.array([s[0], s[0], s[1]])
        case ShapeKind.CAPSULE:
            return np.array([s[0], s[0], s[1] + s[0]])
        case _:
            return np.asarray(s, dtype=np.float64)


def robot_inertia(
    mass: float, lower: NDArray[np.float64], upper: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Centre of mass (3,) and principal inertia (3,) of a robot that fills a box.

    The inertia is that of a solid box (m/12 (b^2 + c^2)); the centre lies low, see
    `ROBOT_CENTRE_HEIGHT`.
    """
    size = np.maximum(upper - lower, 0.02)
    centre = (lower + upper) / 2
    centre[2] = lower[2] + ROBOT_CENTRE_HEIGHT * (upper[2] - lower[2])
    squares = size**2
    return centre, mass / 12 * (squares.sum() - squares)
