"""What watched bodies and the shapes of sensors touch."""

from __future__ import annotations

import math
from functools import cached_property
from typing import TYPE_CHECKING

import mujoco
import numpy as np

from morse.mathutils.portable import matmul
from morse.physics.engine_functions import boxes_of
from morse.physics.model.layout import Motion
from morse.physics.rays.solids import body_of, owner
from morse.scene import PhysicsType

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from morse.physics.objects.gameobject import GameObject
    from morse.physics.objects.object_world import ObjectWorld
    from morse.physics.reactions import ContactPoints
    from morse.scene import Node


#: a static body below whose contact normal is within 45 degrees of the vertical carries a body: it is the floor
_UPRIGHT = 0.5**0.5


class Touches:
    """Adds up the contacts of watched bodies over the engine's steps of a tick.

    The floor does not count: static bodies that carry the body from below.

    Args:
        points: finds the contacts of sleeping bodies.

    Attributes:
        impulses: name of a watched body to what it has touched in the last tick: name of the other body to the
            magnitude of the impulse, N s.
    """

    def __init__(self, world: ObjectWorld, points: ContactPoints, impulses: dict[str, dict[str, float]]) -> None:
        self._world, self._points = world, points
        self._force = np.zeros(6)
        self._owners = np.array([owner(world, world.slot_of[node]) for node in world.geom_node], np.intp)
        self.impulses = impulses
        #: which shapes belong to watched bodies
        self._is_watched = np.zeros(len(self._owners), bool)
        self._slots: dict[int, str] = {}
        self._resting: dict[int, dict[str, float]] = {}
        self._trees: list[int] = []
        for name in impulses:
            self.watch(name)

    def watch(self, name: str) -> None:
        """Watch a body, with its wheels and links; an object that does not move touches nothing."""
        self.impulses.setdefault(name, {})
        slot = self._world.named.get(name)
        if slot is not None:
            self._slots[owner(self._world, slot)] = name
            self._is_watched = np.isin(self._owners, list(self._slots))
            bodies = [body for one in self._slots if (body := self._world.slots[one].body) > 0]
            self._trees = [tree for tree in self._world.model.body_treeid[bodies].tolist() if tree >= 0]

    @property
    def has_work(self) -> bool:
        """Whether the part acts in the next ticks."""
        return True

    @property
    def is_idle(self) -> bool:
        """Whether the watched bodies move, and have touched nothing in the last tick."""
        if self._resting or True in map(bool, self.impulses.values()):
            return False
        asleep = self._world.data.tree_asleep
        for tree in self._trees:  # noqa: SIM110 (a loop takes half the time of a generator)
            if asleep[tree] >= 0:
                return False
        return True

    def before_step(self) -> None:
        """Forget what was touched, at the beginning of a tick and before its steps are repeated."""
        for impulses in self.impulses.values():
            impulses.clear()

    def run(self, steps: int) -> None:
        """Run steps of the engine."""
        state = self._world
        for _ in range(steps):
            state.take_steps(1)
            if state.data.ncon:
                self._add(state.data, state.model.opt.timestep)

    def after_step(self) -> None:
        """Called at the end of a tick: the engine removes the contacts of sleeping bodies, which stay at rest."""
        data, model = self._world.data, self._world.model
        for slot, name in self._slots.items():
            body = self._world.slots[slot].body
            tree = int(model.body_treeid[body]) if body > 0 else -1
            if tree < 0 or data.tree_asleep[tree] < 0:
                self._resting.pop(slot, None)
                continue
            if slot not in self._resting:
                impulses = self.impulses[name]
                impulses.clear()
                with self._points.everything() as copy:
                    if copy is not None:
                        self._add(copy, self._world.period)
                self._resting[slot] = dict(impulses)
            self.impulses[name].update(self._resting[slot])

    def forget(self) -> None:
        """Forget what bodies rest on, because the state was replaced."""
        self._resting.clear()
        self.before_step()

    def _add(self, data: mujoco.MjData, duration: float) -> None:
        contact = data.contact
        pairs = contact.geom[: data.ncon]
        chosen = np.flatnonzero(self._is_watched[pairs].any(axis=1))
        if not len(chosen):
            return
        pairs = pairs[chosen]
        columns = (chosen, pairs, self._owners[pairs], contact.frame[chosen, 2], contact.efc_address[chosen])
        for index, geoms, owners, up, address in zip(*(column.tolist() for column in columns), strict=True):
            if address < 0 or owners[0] == owners[1]:
                continue
            # the normal points from the first body to the second one; most contacts are those with the floor
            sides = [
                (name, geoms[1 - own], owners[1 - own])
                for own, upward in ((0, -up), (1, up))
                if (name := self._slots.get(owners[own])) is not None
                and not (upward > _UPRIGHT and self._is_fixed(owners[1 - own]))
            ]
            if not sides:
                continue
            mujoco.mj_contactForce(self._world.model, data, index, self._force)
            if not self._force[0] > 0.0:
                continue
            impulse = float(np.sqrt((self._force[:3] ** 2).sum())) * duration
            for name, geom, slot in sides:
                self._note(name, geom, slot, impulse)

    def _is_fixed(self, slot: int) -> bool:
        return self._world.slots[slot].frame.motion is Motion.FIXED

    def _note(self, name: str, geom: int, slot: int, impulse: float) -> None:
        world = self._world
        other = (world.geom_node[geom] if self._is_fixed(slot) else world.slots[slot].frame.node).name
        impulses = self.impulses[name]
        impulses[other] = impulses.get(other, 0.0) + impulse


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
