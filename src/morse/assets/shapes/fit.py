"""Solids fitted to points."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from morse.assets.shapes.part import Primitive
from morse.assets.shapes.surface import rows_of_three
from morse.mathutils.portable import matmul, solve
from morse.scene.body import Bounds

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

SMALLEST_HALF = 1e-3
"""Minimum half size of a solid, m, because the physics does not accept flat solids."""


def fit_bounds(vertices: ArrayLike, bounds: Bounds) -> Primitive:
    """The solid of the given kind around the axis-aligned bounding box of a mesh.

    Args:
        vertices: (V, 3) metres; vertices that are not finite are ignored.
        bounds: BOX, SPHERE (radius: the largest half size), CYLINDER, CONE or CAPSULE (along Z; radius: the larger of
            the half sizes in X and Y; a capsule has the length of the box).

    Raises:
        ValueError: there are no vertices, or the bounds are a mesh.
    """
    points: NDArray[np.float64] = rows_of_three(vertices, "vertices").astype(np.float64)
    points = points[np.isfinite(points).all(axis=1)]
    if len(points) == 0:
        raise ValueError(f"bounds {bounds} need a vertex with finite coordinates, given none")
    low, high = points.min(axis=0), points.max(axis=0)
    centre = (low + high) / 2.0
    x, y, z = np.maximum((high - low) / 2.0, SMALLEST_HALF).tolist()
    match bounds:
        case Bounds.BOX:
            return Primitive("box", (x, y, z), centre)
        case Bounds.SPHERE:
            return Primitive("sphere", (max(x, y, z),), centre)
        case Bounds.CYLINDER:
            return Primitive("cylinder", (max(x, y), z), centre)
        case Bounds.CONE:
            return Primitive("cone", (max(x, y), z), centre)
        case Bounds.CAPSULE:
            radius = max(x, y)
            return Primitive("capsule", (radius, max(z - radius, SMALLEST_HALF)), centre)
    raise ValueError(f"bounds {bounds} are not a primitive: use convex_parts")


def fit_round(points: NDArray[np.float64]) -> tuple[NDArray[np.float64], float] | None:
    """Centre (D,) and radius of the circle or sphere through points (P, D) in the least squares sense.

    Linear in the centre c and in r² - c²: I. D. Coope, "Circle fitting by linear and nonlinear least squares", J.
    Optim. Theory Appl. 76 (1993). None if the points do not determine the circle or sphere.
    """
    dimension = points.shape[1]
    if len(points) <= dimension:
        return None
    middle = points.mean(axis=0)
    local = points - middle
    size = float(np.abs(local).max())
    if not size > 0.0:
        return None
    local = local / size
    system = np.column_stack([2.0 * local, np.ones(len(local))])
    solution = solve(matmul(system.T, system), matmul(system.T, (local * local).sum(axis=1)))
    if solution is None:
        return None
    square = float(solution[dimension] + matmul(solution[:dimension], solution[:dimension]))
    if not square > 0.0:
        return None
    return middle + size * solution[:dimension], size * math.sqrt(square)
