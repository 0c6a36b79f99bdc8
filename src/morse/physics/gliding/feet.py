"""Feet under driven robots.

A hull that rests on a floor with its whole underside is slow to simulate and catches on the seams of floors. Four
spheres at the rim of the underside carry the robot instead. They slide over seams, and the engine has a closed-form
solution for the contact of a sphere and a box. The hull is trimmed by a few millimetres so that it does not touch the
floor.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from morse.mathutils.portable import matmul
from morse.scene import CollisionShape, ShapeKind

if TYPE_CHECKING:
    from numpy.typing import NDArray

#: share of the height that is trimmed off the hull, and at most that many metres
_TRIM, _TRIM_LIMIT = 0.02, 0.01
#: radius of a foot: a share of the smaller half width, within limits in metres
_RADIUS, _RADIUS_LIMITS = 0.15, (0.005, 0.05)


@dataclass(frozen=True, slots=True)
class Stance:
    """The contact geometry of a robot with the floor.

    Attributes:
        feet: (4, 3) centres of the spheres in the frame of the robot, m.
        radius: radius of the spheres, m.
        floor: height of the underside in the frame of the robot, m.
        clearance: height by which the hull is trimmed, m.
        height: height of the hull, m.
    """

    feet: NDArray[np.float64]
    radius: float
    floor: float
    clearance: float
    height: float


def stance(points: NDArray[np.float64]) -> Stance | None:
    """Return the stance of a hull, given its corners (P, 3) in the frame of the robot.

    The last stances are kept, because those of all robots are asked for again whenever an object is spawned or deleted.

    Returns:
        None for a hull without a flat underside, e.g. a sphere or a blade.
    """
    return _stance(np.ascontiguousarray(points, dtype=np.float64).tobytes())


@lru_cache(maxsize=64)
def _stance(corners: bytes) -> Stance | None:
    points = np.frombuffer(corners).reshape(-1, 3)
    low, high = points.min(axis=0), points.max(axis=0)
    height = float(high[2] - low[2])
    clearance = min(_TRIM * height, _TRIM_LIMIT)
    under = points[points[:, 2] <= low[2] + 2.0 * clearance]
    half = np.ptp(under[:, :2], axis=0) / 2 if len(under) else np.zeros(2)
    if clearance < 1e-4 or half.min() < 0.25 * np.ptp(points[:, :2], axis=0).min() or half.min() < 0.02:
        return None
    radius = float(np.clip(_RADIUS * half.min(), *_RADIUS_LIMITS))
    centre = (under[:, :2].min(axis=0) + under[:, :2].max(axis=0)) / 2
    reach = np.array([[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]]) * (half - radius)
    if _corner_share(under[:, :2] - centre, half) < 0.9:
        # a round underside has no corners, so the feet are placed on the circle
        reach *= math.sqrt(0.5)
    feet = np.column_stack([centre + reach, np.full(4, low[2] + radius)])
    return Stance(feet, radius, float(low[2]), clearance, height)


def _corner_share(points: NDArray[np.float64], half: NDArray[np.float64]) -> float:
    """Return how far the underside reaches towards the corners of its bounding rectangle: 1 for a rectangle."""
    return float((np.abs(points) / half).sum(axis=1).max() / 2.0)


def trimmed(
    shape: CollisionShape, position: NDArray[np.float64], rotation: NDArray[np.float64], stand: Stance
) -> CollisionShape | None:
    """Cut off the part of a shape below the clearance; return None if it cannot be trimmed.

    Args:
        position: (3,) position of the node of the shape in the frame of the robot, m.
        rotation: (3, 3) rotation of the node of the shape.
    """
    bottom = stand.floor + stand.clearance
    if shape.kind is ShapeKind.CONVEX:
        assert shape.vertices is not None
        points = matmul(shape.vertices, rotation.T) + position
        if points[:, 2].min() >= bottom:
            return shape
        top = points[:, 2].max()
        share = (top - bottom) / max(top - points[:, 2].min(), 1e-9)
        points[:, 2] = top - (top - points[:, 2]) * share
        return CollisionShape(shape.kind, (), vertices=matmul(points - position, rotation))
    shape_rotation = matmul(rotation, np.reshape(shape.rotation, (3, 3)))
    if shape.kind not in (ShapeKind.BOX, ShapeKind.CYLINDER) or abs(abs(shape_rotation[2, 2]) - 1.0) > 1e-6:
        return None
    half = shape.size[-1]
    centre = position + matmul(rotation, np.asarray(shape.position))
    height = bottom - (centre[2] - half)
    if height <= 0.0:
        return shape
    if height >= half:
        return None
    new_centre = matmul(rotation.T, centre + np.array([0.0, 0.0, height / 2]) - position)
    x, y, z = new_centre.tolist()
    return CollisionShape(shape.kind, (*shape.size[:-1], half - height / 2), (x, y, z), shape.rotation)
