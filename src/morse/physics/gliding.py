"""Driven robots that glide over a level floor.

A driven robot slides without friction. While all of its feet stand on one level floor and nothing else
touches it, the floor does no more than carry its weight: its height and tilt stay, and it moves across
as its velocity says. Then the contacts of its feet need not be solved: the robot is made weightless,
and passes through that floor, which it never enters; that spares two thirds of the time of a physics step.

Everything else goes on touching it. Should anything do so within a tick, or should anything try to lift,
turn over or push down the robot, the tick is taken back and done again with its feet on the floor.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import mujoco
import numpy as np

from morse.physics.floors import ALL_BITS, Floor, find_floors

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from morse.physics.compile import Slot
    from morse.physics.drive import Command
    from morse.physics.world import World

#: a robot has come to stand if a tick changes neither its height (m) nor its tilt by more
_SETTLED = 1e-9
#: feet stand on a floor that is so near to them, m: a body sinks in by a little
_NEAR = 2e-3
#: speeds within a tick that are not those of the command, m/s and rad/s: something acts on the robot
_DISTURBED = 1e-7
#: the tilt is looked at so often, in ticks: a body that turns about a slanting axis begins to tumble
_LOOK = 300
#: metres to the edge of the floor at which feet touch it again
_EDGE = 0.01
#: ticks that a robot which was disturbed waits before it glides again: at first, and at most
_WAIT, _LONGEST_WAIT = 4, 256
_STATE = mujoco.mjtState.mjSTATE_INTEGRATION


@dataclass(slots=True)
class _Stand:
    """How a robot stood a tick ago, and what it has met.

    Attributes:
        tick: when.
        height: of its origin, m.
        up: the vertical in its own axes.
        wait: ticks until it may glide, if it is disturbed again.
        until: it may not glide before that tick.
    """

    tick: int = -1
    height: float = 0.0
    up: Sequence[float] = (0.0, 0.0, 1.0)
    wait: int = _WAIT
    until: int = 0


@dataclass(slots=True)
class _Glide:
    """A robot that glides.

    Attributes:
        up: the vertical in its own axes.
        look: tick at which it could be near an edge.
        speed: m/s at which that was worked out.
        since: tick at which it began.
    """

    slot: Slot
    floor: Floor
    up: Sequence[float]
    look: int
    speed: float
    since: int


class Gliding:
    """The robots of a world that glide.

    Attributes:
        slots: the indices of their slots.
    """

    def __init__(self, world: World) -> None:
        self._world = world
        model = world.model
        self._able = {index: self._reach(slot) for index, slot in enumerate(world.slots) if self._is_able(slot)}
        self._floors = find_floors(world) if self._able else []
        touching = model.geom_contype != 0
        self._bits = np.where(touching, ALL_BITS, 0).astype(np.int32)
        for floor in self._floors:
            self._bits[floor.geom] = floor.bit
        model.geom_contype[:] = model.geom_conaffinity[:] = self._bits
        self._owner = np.full(model.ngeom, -1)
        for index in self._able:
            self._owner[self._geoms(world.slots[index])] = index
        self._state = np.empty(mujoco.mj_stateSize(model, _STATE))
        self.reset()

    @staticmethod
    def _is_able(slot: Slot) -> bool:
        return len(slot.feet) == 4

    def _reach(self, slot: Slot) -> float:
        """Metres from the origin of a robot to its outermost foot, seen from above."""
        places = self._world.model.geom_pos[slot.feet]
        return float(np.hypot(places[:, 0], places[:, 1]).max())

    @staticmethod
    def _geoms(slot: Slot) -> list[int]:
        return [*(geom for geoms in slot.geoms.values() for geom in geoms), *slot.feet]

    def reset(self) -> None:
        """Nobody glides; the model is as it was compiled."""
        self._glides: dict[int, _Glide] = {}
        self._stands: dict[int, _Stand] = {}
        self._gone: set[int] = set()
        self._tick = 0
        self._look = 0

    # -- masks -----------------------------------------------------------------------------

    def set_collision(self, geoms: Iterable[int], active: bool) -> None:
        """Let shapes collide, or pass through everything."""
        model = self._world.model
        for geom in geoms:
            bits = self._bits[geom] or ALL_BITS
            model.geom_contype[geom] = model.geom_conaffinity[geom] = bits if active else 0

    # -- who glides ------------------------------------------------------------------------

    @property
    def slots(self) -> Iterable[int]:
        """The indices of the slots that glide."""
        return self._glides.keys()

    def __contains__(self, index: int) -> bool:
        return index in self._glides

    def consider(self, index: int, command: Command) -> None:
        """A robot is driven over the ground during this tick: let it glide if it can."""
        if index not in self._able:
            return
        world = self._world
        height, up = world.positions[index][2], world.rotations[index][6:9]
        stand = self._stands.setdefault(index, _Stand())
        has_settled = (
            stand.tick == self._tick - 1
            and abs(height - stand.height) < _SETTLED
            and max(abs(a - b) for a, b in zip(up, stand.up, strict=True)) < _SETTLED
        )
        stand.tick, stand.height, stand.up = self._tick, height, up
        if not has_settled or self._tick < stand.until or not _is_flat(command):
            return
        slot = world.slots[index]
        if world.data.xfrc_applied[slot.body].any() or world.model.body_gravcomp[slot.body]:
            return
        floor = self._floor_under(index, slot)
        if floor is not None and not self._touches_else(index, floor):
            self._begin(index, slot, floor, command)

    def _floor_under(self, index: int, slot: Slot) -> Floor | None:
        """The floor that all feet stand on, none of them near its edge."""
        world = self._world
        places, radii = world.data.geom_xpos[slot.feet], world.model.geom_size[slot.feet, 0]
        soles = places[:, 2] - radii
        x, y, _ = world.positions[index]
        for floor in self._floors:
            if floor.slot in world.loose or floor.room(x, y) < self._able[index] + 2 * _EDGE:
                continue
            gaps = soles - floor.height
            if gaps.min() > -_NEAR and gaps.max() <= 0.0 and world.model.geom_contype[floor.geom]:
                return floor
        return None

    def _touches_else(self, index: int, floor: Floor) -> bool:
        data = self._world.data
        pairs = data.contact.geom[: data.ncon]
        own = self._owner[pairs] == index
        expected = np.isin(pairs, self._world.slots[index].feet).any(axis=1) & (pairs == floor.geom).any(axis=1)
        return bool((own.any(axis=1) & ~expected).any())

    def _begin(self, index: int, slot: Slot, floor: Floor, command: Command) -> None:
        model = self._world.model
        for geom in self._geoms(slot):
            if model.geom_contype[geom]:
                model.geom_contype[geom] = model.geom_conaffinity[geom] = ALL_BITS & ~floor.bit
        model.body_gravcomp[slot.body] = 1.0
        self._glides[index] = glide = _Glide(slot, floor, self._world.rotations[index][6:9], 0, 0.0, self._tick)
        self._plan(index, glide, math.hypot(command.linear[0], command.linear[1]))
        if glide.look <= self._tick:
            self.leave(index)

    def _plan(self, index: int, glide: _Glide, speed: float) -> None:
        """Work out until when the robot cannot be near an edge."""
        x, y, _ = self._world.positions[index]
        room = glide.floor.room(x, y) - self._able[index] - _EDGE
        glide.speed = max(2.0 * speed, 0.1)
        ticks = math.floor(room / (glide.speed * self._world.period)) if room > 0.0 else 0
        glide.look = self._tick + min(ticks, _LOOK)
        self._look = min(self._look, glide.look) if len(self._glides) > 1 else glide.look

    def leave(self, index: int) -> None:
        """Stand on the feet again."""
        glide = self._glides.pop(index, None)
        if glide is None:
            return
        model = self._world.model
        for geom in self._geoms(glide.slot):
            if model.geom_contype[geom]:
                model.geom_contype[geom] = model.geom_conaffinity[geom] = ALL_BITS
        model.body_gravcomp[glide.slot.body] = 0.0

    def leave_all(self) -> None:
        """Stand on the feet again: a floor may have moved."""
        for index in list(self._glides):
            self.leave(index)

    # -- a tick ----------------------------------------------------------------------------

    def may_go_on(self, index: int, command: Command) -> bool:
        """Whether a robot that glides can do so under this command."""
        glide = self._glides[index]
        vx, vy, vz = command.linear
        wx, wy, wz = command.angular
        if vz or wx or wy or not (vx or vy or wz):
            return False
        speed = math.sqrt(vx * vx + vy * vy)
        if speed > glide.speed:
            self._plan(index, glide, speed)
            return glide.look > self._tick
        return True

    def look(self) -> None:
        """A tick begins: see to those that could be near an edge."""
        self._tick += 1
        if self._glides and self._tick >= self._look:
            for index, glide in list(self._glides.items()):
                if glide.look <= self._tick:
                    self._look_at(index, glide)
            self._look = min((glide.look for glide in self._glides.values()), default=0)

    def _look_at(self, index: int, glide: _Glide) -> None:
        up = self._world.rotations[index][6:9]
        if max(abs(a - b) for a, b in zip(up, glide.up, strict=True)) > 100 * _SETTLED:
            self.leave(index)
            return
        self._plan(index, glide, glide.speed / 2.0)
        if glide.look <= self._tick:
            self.leave(index)

    def save(self) -> None:
        """Remember the state, to take the tick back if need be."""
        if self._glides:
            data = self._world.data
            mujoco.mj_getState(self._world.model, data, self._state, _STATE)
            data.maxuse_con = 0

    def take_back(self) -> bool:
        """If a robot was disturbed while it glided, go back to the state remembered, and let it stand on its feet."""
        data = self._world.data
        if not self._glides or data.maxuse_con == 0:
            return False
        disturbed = self._disturbed()
        if not disturbed:
            return False
        mujoco.mj_setState(self._world.model, data, self._state, _STATE)
        data.maxuse_con = 0
        for index in disturbed:
            stand, glide = self._stands[index], self._glides[index]
            if self._tick - glide.since > _LONGEST_WAIT:
                stand.wait = _WAIT
            stand.until = self._tick + stand.wait
            stand.wait = min(2 * stand.wait, _LONGEST_WAIT)
            self.leave(index)
        return True

    def _disturbed(self) -> list[int]:
        data = self._world.data
        touched = set(self._owner[data.contact.geom[: data.ncon]].ravel().tolist()) if data.ncon else set()
        found = []
        for index, glide in self._glides.items():
            dof = glide.slot.dof
            vz, *rates = data.qvel[dof + 2 : dof + 6].tolist()
            up = glide.up
            along = sum(a * b for a, b in zip(up, rates, strict=True))
            tumbling = max(abs(rate - along * axis) for rate, axis in zip(rates, up, strict=True))
            if index in touched or abs(vz) > _DISTURBED or tumbling > _DISTURBED:
                found.append(index)
        return found

    def supports(self) -> list[tuple[int, int]]:
        """The contacts that are not solved: pairs of geoms, foot and floor."""
        return [(foot, glide.floor.geom) for glide in self._glides.values() for foot in glide.slot.feet]


def _is_flat(command: Command) -> bool:
    """Whether a command moves a robot along the floor only."""
    return not (command.linear[2] or command.angular[0] or command.angular[1])
