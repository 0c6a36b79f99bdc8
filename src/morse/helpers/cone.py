"""Whether a convex shape reaches into a cone."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from morse.mathutils.portable import matmul

if TYPE_CHECKING:
    from numpy.typing import NDArray

#: distance below which shapes touch, m
_TOUCH = 1e-3
_STEPS = 200


class Cone:
    """The points within ``length`` of the origin whose direction differs from X by at most ``half_angle``.

    Args:
        half_angle: rad.
        length: m.
    """

    def __init__(self, half_angle: float, length: float) -> None:
        self._angle = half_angle
        self._length = length
        self._tangent = (math.cos(half_angle), math.sin(half_angle))

    def contains(self, point: NDArray[np.float64]) -> bool:
        """Whether a point (3,) is in the cone."""
        distance = math.sqrt(_dot(point, point))
        inside = distance == 0.0 or math.acos(max(-1.0, min(1.0, float(point[0]) / distance))) <= self._angle
        return inside and distance <= self._length

    def touches(self, points: NDArray[np.float64]) -> bool:
        """Whether the convex hull of points (P, 3) has a point in the cone.

        The point of the hull that is nearest to the cone is approached by the method of Frank and Wolfe, whose gap
        shows early that hull and cone are apart. A cone wider than a half space is not convex: then the points are
        tested alone.
        """
        if any(self.contains(point) for point in points):
            return True
        if self._angle >= 0.5 * math.pi:
            return False
        here = points.mean(axis=0)
        for _ in range(_STEPS):
            away = here - self._nearest(here)
            squared = _dot(away, away)
            if squared <= _TOUCH * _TOUCH:
                return True
            towards = points[int(np.argmin(matmul(points, away)))] - here
            gap = -_dot(away, towards)
            if gap < 0.5 * squared or gap <= 0.0:
                return False
            here = here + min(1.0, gap / _dot(towards, towards)) * towards
        return False

    def _nearest(self, point: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the point of the cone that is nearest to a point."""
        aside = math.hypot(point[1], point[2])
        cosine, sine = self._tangent
        if math.atan2(aside, float(point[0])) > self._angle:
            along = max(0.0, float(point[0]) * cosine + aside * sine)
            share = along * sine / aside if aside else 0.0
            point = np.array([along * cosine, share * point[1], share * point[2]])
        distance = math.sqrt(_dot(point, point))
        return point if distance <= self._length else point * (self._length / distance)


def _dot(one: NDArray[np.float64], other: NDArray[np.float64]) -> float:
    a, b, c = (one * other).tolist()
    return float(a + b + c)
