"""Feet under driven robots, and planes on the level tops of boxes: contacts that the engine computes by formulas.

A hull that rests on a floor with its whole underside is slow to simulate and catches on the seams of floors. Four
spheres at the rim of the underside carry the robot instead. They slide over seams, and the engine has a closed-form
solution for the contact of a sphere and a box. The hull is trimmed by a few millimetres so that it does not touch the
floor.

The engine computes the contacts of a box with an ellipsoid or a cylinder in many iterations, but those with a plane by
a formula, which is also more exact.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import mujoco
import numpy as np

from morse.mathutils.portable import matmul
from morse.physics.model.shapes import FIRST_PLANE, MOST_PLANES
from morse.scene import CollisionShape, ShapeKind

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from morse.core.world import Body

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


#: maximum slope of a level face, for rounding: less than a micrometre per kilometre
_LEVEL = 1e-10


def level_axis(rotation: NDArray[np.float64]) -> int | None:
    """Return the axis of a box that is vertical: 0, 1 or 2; None if no face is level.

    Args:
        rotation: (3, 3) of the box in the world.
    """
    heights = [abs(height) for height in rotation[2].tolist()]
    up = heights.index(max(heights))
    del heights[up]
    return up if max(heights) <= _LEVEL else None


#: smallest half length of a side of a floor with a plane, m: robots on smaller floors are close to the edges
_SMALLEST = 2.0


class PlaneBuilder:
    """Adds planes at the level tops of static boxes.

    Attributes:
        pairs: the geoms of boxes and of their planes.
    """

    def __init__(self) -> None:
        self._tops: list[tuple[float, int, Any, Any, NDArray[np.float64], Callable[[Any], None]]] = []
        self.pairs: list[tuple[Any, Any]] = []

    def note(self, body: Body, geom: Any, rotation: NDArray[np.float64], set_surface: Callable[[object], None]) -> None:
        """Record a shape of a static body.

        Args:
            rotation: (3, 3) of the body in the world.
            set_surface: sets the same friction and restitution for the plane.
        """
        size = np.asarray(geom.size)
        if sorted(size.tolist())[1] < _SMALLEST:  # no face is large enough
            return
        if geom.type != mujoco.mjtGeom.mjGEOM_BOX or not geom.contype:
            return
        own = np.empty(9)
        mujoco.mju_quat2Mat(own, geom.quat)
        world_rotation = matmul(rotation, own.reshape(3, 3))
        up = level_axis(world_rotation)
        if up is None:
            return
        sides = [i for i in range(3) if i != up]
        if size[sides].min() < _SMALLEST:
            return
        axis = own.reshape(3, 3)[:, up] * np.sign(world_rotation[2, up])
        top = np.asarray(geom.pos) + axis * size[up]
        self._tops.append(
            (-float(np.prod(size[sides])), len(self._tops), body, geom, np.array([top, axis]), set_surface)
        )

    def finish(self) -> None:
        """Add planes for the largest floors."""
        for _, _, body, geom, (top, axis), set_surface in sorted(self._tops, key=lambda entry: entry[:2])[:MOST_PLANES]:
            quaternion = np.empty(4)
            mujoco.mju_quatZ2Vec(quaternion, axis)
            plane = body.add_geom(
                type=mujoco.mjtGeom.mjGEOM_PLANE, size=[0.0, 0.0, 1.0], pos=top, quat=quaternion, mass=0.0
            )
            set_surface(plane)
            # the engine never tests shapes that are compiled without bits
            plane.contype = plane.conaffinity = FIRST_PLANE << len(self.pairs)
            # the viewer of MuJoCo shows the box
            plane.rgba = [0.0, 0.0, 0.0, 0.0]
            self.pairs.append((geom, plane))
