"""Finds the objects that touch the shape of a sensor."""

from __future__ import annotations

import math
from functools import cached_property
from typing import TYPE_CHECKING

import mujoco
import numpy as np

from morse.mathutils.portable import matmul
from morse.physics.model.layout import Motion
from morse.physics.nearby import boxes_of
from morse.physics.rays.solids import body_of, owner
from morse.scene import PhysicsType

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from morse.physics.objects.gameobject import GameObject
    from morse.physics.objects.object_world import ObjectWorld
    from morse.scene import Node


#: tolerance for rounding, m
_ROUNDING = 1e-6


class Touching:
    """Finds the objects whose shapes touch the shapes of another object, which may collide or only detect contacts.

    The engine needs some microseconds to compute the distance of two shapes. Shapes that are too far away are therefore
    excluded first, by the bounding boxes of static shapes and the bounding spheres of moving shapes.
    """

    def __init__(self, world: ObjectWorld) -> None:
        self._world = world
        model, data = world.model, world.data
        # references to the arrays of the engine, because each access through the model takes longer than the use
        self._places, self._turns, self._radii = data.geom_xpos, data.geom_xmat, model.geom_rbound
        self._halves = np.abs(model.geom_aabb[:, :3]) + model.geom_aabb[:, 3:]
        self._feelers: dict[Node, list[int]] = {}
        #: for each shape: static boxes, its centre, and the distance within which it can move without meeting the
        #: boxes, m
        self._clear: dict[int, tuple[object, list[float], float]] = {}
        self._others: dict[tuple[int, int], tuple[NDArray[np.intp], NDArray[np.float64]]] = {}
        self._kept: tuple[NDArray[np.float64], NDArray[np.float64]] | None = None
        self._where: NDArray[np.float64] = np.empty((0, 12))
        self._loosened = False

    def objects(self, obj: GameObject, margin: float) -> list[GameObject]:
        """Return the objects closer than ``margin`` (m) to the shapes of an object, except those that move with it.

        An object with several shapes is returned once.
        """
        world = self._world
        own = self._body_of_slot[obj.slot]
        objects: dict[GameObject, None] = {}
        for geom in self._feelers_of(obj):
            for other in self._near(geom, own, margin):
                if mujoco.mj_geomDistance(world.model, world.data, geom, other, 2.0 * margin + 1e-6, None) <= margin:
                    objects[body_of(world, world.object_of(world.geom_node[other]))] = None
        return list(objects)

    def _feelers_of(self, obj: GameObject) -> list[int]:
        feelers = self._feelers.get(obj.node)
        if feelers is None:
            geoms = self._world.slots[obj.slot].geoms
            feelers = self._feelers[obj.node] = [geom for node in obj.node.walk() for geom in geoms.get(node, ())]
        return feelers

    @cached_property
    def _body_of_slot(self) -> list[int]:
        """Return the slot of the body of each slot: wheels are parts of robots."""
        return [owner(self._world, slot) for slot in range(len(self._world.slots))]

    @cached_property
    def _solids(self) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        """Return the shapes that can be touched: static shapes, and moving shapes."""
        fixed: list[int] = []
        moving: list[int] = []
        for slot in self._world.slots:
            for node, geoms in slot.geoms.items():
                if node.body.type is not PhysicsType.SENSOR and (node.body.collides or slot.frame.node.body.collides):
                    (fixed if slot.frame.motion is Motion.FIXED else moving).extend(geoms)
        return np.array(sorted(fixed), dtype=np.intp), np.array(sorted(moving), dtype=np.intp)

    @cached_property
    def _movers(self) -> tuple[NDArray[np.float64], list[int]]:
        """Return the radius of the bounding sphere and the body of each moving shape."""
        world, moving = self._world, self._solids[1]
        return self._radii[moving], [self._body_of_slot[world.slot_of[world.geom_node[geom]]] for geom in moving]

    def _near(self, geom: int, own: int, margin: float) -> Iterator[int]:
        centre = self._places[geom]
        fixed, moving = self._solids
        if len(fixed):
            boxes = self._boxes(fixed)
            clear, where, room = self._clear.get(geom, (None, [], 0.0))
            if clear is not boxes or math.dist(where, centre.tolist()) + margin >= room:
                yield from self._near_fixed(geom, fixed, boxes, margin)
        if len(moving):
            others, radii = self._others_than(own, geom)
            if len(others):
                apart = self._places.take(others, axis=0) - centre
                reach = radii + margin
                near = (apart * apart).sum(axis=1) <= reach * reach
                if near.any():
                    yield from others[near].tolist()

    def _near_fixed(
        self, geom: int, fixed: NDArray[np.intp], boxes: tuple[NDArray[np.float64], NDArray[np.float64]], margin: float
    ) -> list[int]:
        centre, (lower, upper) = self._places[geom], boxes
        half = self._half_of_box(geom) + margin
        meets = ((lower <= centre + half) & (upper >= centre - half)).all(axis=1)
        if meets.any():
            geoms: list[int] = fixed[meets].tolist()
            return geoms
        gaps = np.maximum(np.maximum(lower - centre, centre - upper), 0.0)
        room = math.sqrt(float((gaps * gaps).sum(axis=1).min())) - float(self._radii[geom])
        self._clear[geom] = boxes, centre.tolist(), room - _ROUNDING
        return []

    def _others_than(self, own: int, geom: int) -> tuple[NDArray[np.intp], NDArray[np.float64]]:
        """Return the moving shapes of other bodies, and the distances of their centres at which they meet, m."""
        cached = self._others.get((own, geom))
        if cached is None:
            moving, (radii, bodies) = self._solids[1], self._movers
            is_other = np.array(bodies) != own
            cached = self._others[own, geom] = moving[is_other], radii[is_other] + self._radii[geom]
        return cached

    def _half_of_box(self, geom: int) -> NDArray[np.float64]:
        """Return (3,) half sizes of an axis-aligned box around a shape, centred at the origin of the shape, m."""
        half_extents: NDArray[np.float64] = matmul(np.abs(self._turns[geom]).reshape(3, 3), self._halves[geom])
        return half_extents

    def _boxes(self, fixed: NDArray[np.intp]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return (N, 3) lower and upper corners around static bodies; computed again after a static body was moved."""
        world = self._world
        if self._kept is None or world.loose or self._loosened:
            where = np.hstack([self._places[fixed], self._turns[fixed]])
            if self._kept is None or not np.array_equal(where, self._where):
                boxes = boxes_of(world, fixed)
                planes = world.model.geom_type[fixed] == mujoco.mjtGeom.mjGEOM_PLANE
                boxes[planes, 0], boxes[planes, 1] = -np.inf, np.inf
                self._where, self._kept = where, (boxes[:, 0].copy(), boxes[:, 1].copy())
            self._loosened = bool(world.loose)
        return self._kept
