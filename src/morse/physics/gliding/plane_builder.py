"""Adds the planes of `morse.physics.gliding.floor_planes` to a model before it is compiled."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import mujoco
import numpy as np

from morse.mathutils.portable import matmul
from morse.physics.gliding.level import level_axis
from morse.physics.model.collision_bits import FIRST_PLANE, MOST_PLANES

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from morse.core.world import Body

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
