"""What watched bodies have touched in a tick, with the impulses of the contacts."""

from __future__ import annotations

from typing import TYPE_CHECKING

import mujoco
import numpy as np

from morse.physics.model.layout import Motion
from morse.physics.rays.solids import owner

if TYPE_CHECKING:
    from morse.physics.contact_points import ContactPoints
    from morse.physics.objects.object_world import ObjectWorld

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
