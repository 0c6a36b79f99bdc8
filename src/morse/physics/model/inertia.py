"""Mass properties of bodies."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING
from weakref import WeakKeyDictionary

import numpy as np

from morse.mathutils.portable import matmul
from morse.scene import ShapeKind

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from morse.scene import CollisionShape

#: height of the centre of mass of a driven robot as a share of its height; it is low because batteries and motors are
#: mounted low, and because the robot would topple too easily otherwise
ROBOT_CENTRE_HEIGHT = 0.2


#: volumes of convex hulls, which are asked for again whenever an object is spawned or deleted
_volumes: WeakKeyDictionary[CollisionShape, float] = WeakKeyDictionary()


def volume(shape: CollisionShape) -> float:
    """Return the volume of a shape, m^3 (for a convex hull, of its bounding box)."""
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
        case ShapeKind.HEIGHT_FIELD:
            return 4 * s[0] * s[1] * (s[2] / 2 + s[3])
        case ShapeKind.CONVEX:
            value = _volumes.get(shape)
            if value is None:
                assert shape.vertices is not None
                value = _volumes[shape] = float(np.prod(np.maximum(np.ptp(shape.vertices, axis=0), 1e-3)))
            return value


def bounding_box(
    shape: CollisionShape, position: NDArray[np.float64], rotation: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the lower and upper corner (3,) of a shape, given the pose of its node in the wanted frame, m."""
    if shape.kind is ShapeKind.CONVEX:
        assert shape.vertices is not None
        points = matmul(shape.vertices, rotation.T) + position
        return points.min(axis=0), points.max(axis=0)
    shape_rotation = matmul(rotation, np.reshape(shape.rotation, (3, 3)))
    centre = position + matmul(rotation, np.asarray(shape.position))
    half = half_sizes(shape)
    extent = matmul(np.abs(shape_rotation), half) if shape.kind is not ShapeKind.SPHERE else half
    return centre - extent, centre + extent


def half_sizes(shape: CollisionShape) -> NDArray[np.float64]:
    """Return the half sizes (3,) of the box around a primitive, in its own frame, m."""
    s = shape.size
    match shape.kind:
        case ShapeKind.SPHERE:
            return np.full(3, s[0])
        case ShapeKind.CYLINDER:
            return np.array([s[0], s[0], s[1]])
        case ShapeKind.CAPSULE:
            return np.array([s[0], s[0], s[1] + s[0]])
        case ShapeKind.HEIGHT_FIELD:
            return np.array([s[0], s[1], max(s[2], s[3])])
        case _:
            return np.asarray(s, dtype=np.float64)


def robot_inertia(
    mass: float, lower: NDArray[np.float64], upper: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the centre of mass (3,) and the principal inertia (3,) of a robot that fills a box.

    The inertia is that of a solid box (m/12 (b^2 + c^2)). For the height of the centre see `ROBOT_CENTRE_HEIGHT`.
    """
    size = np.maximum(upper - lower, 0.02)
    centre = (lower + upper) / 2
    centre[2] = lower[2] + ROBOT_CENTRE_HEIGHT * (upper[2] - lower[2])
    squares = size**2
    return centre, mass / 12 * (squares.sum() - squares)


#: density of links without masses in the file, kg/m^3
_DENSITY = 1000.0


def mass_of(
    shape: CollisionShape, position: NDArray[np.float64], rotation: NDArray[np.float64]
) -> tuple[float, NDArray[np.float64], NDArray[np.float64]]:
    """Return mass (kg), centre (3,) and inertia (3, 3) about the centre of a shape with the density of water.

    The inertia is that of a solid box of the size of the shape.

    Args:
        position: position of the node in the wanted frame, m.
        rotation: (3, 3) rotation of the node in the wanted frame.
    """
    mass = _DENSITY * volume(shape)
    if shape.kind is ShapeKind.CONVEX:
        assert shape.vertices is not None
        low, high = shape.vertices.min(axis=0), shape.vertices.max(axis=0)
        centre, half, shape_rotation = (low + high) / 2.0, (high - low) / 2.0, rotation
    else:
        centre, half = np.asarray(shape.position), half_sizes(shape)
        shape_rotation = matmul(rotation, np.reshape(shape.rotation, (3, 3)))
    squares = (2.0 * half) ** 2
    moments = mass / 12.0 * (squares.sum() - squares)
    return (
        mass,
        position + matmul(rotation, centre),
        matmul(matmul(shape_rotation, np.diag(moments)), shape_rotation.T),
    )


def moved_inertia(inertia: NDArray[np.float64], mass: float, by: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the inertia (3, 3) about a point at a distance from the centre of mass (parallel axis theorem)."""
    return np.asarray(inertia + mass * (float(matmul(by, by)) * np.eye(3) - np.outer(by, by)))
