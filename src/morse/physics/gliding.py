"""Driven robots that glide over a level floor.

A driven robot slides without friction. While all of its feet stand on one level floor and nothing else
touches it, the floor does no more than carry its weight: its height and tilt stay, and it moves across
as its velocity says. Then the contacts of its feet need not be solved: the robot is made weightless,
and passes through that floor, which it never enters; that spares two thirds of the time of a physics step.

If nothing else is awake, there is nothing to solve at all: one step as long as the tick does the same as
several short ones, as long as nothing comes near enough to be met within the tick.

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

    from numpy.typing import NDArray

    from morse.physics.compile import Slot
    from morse.physics.drive import Command
    from morse.physics.world import World

#: a robot has come to stand if a tick changes neither its height (m) nor its tilt by more
_SETTLED = 1e-9
#: feet stand on a floor that is so near to them, m: a body sinks in by a little
_NEAR = 2e-3
#: what lies lower than the feet by more than that, m, cannot be met
_CLEAR = 1e-6
#: speeds within a tick that are not those of the command, m/s and rad/s: something acts on the robot
_DISTURBED = 1e-7
#: the tilt is looked at so often, in ticks: a body that turns about a slanting axis begins to tumble
_LOOK = 300
#: metres to the edge of the floor at which feet touch it again
_EDGE = 0.01
#: a centre of mass that is so near above the origin, m, follows it in one step as in several
_CENTRED = 1e-7
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
        margin: metres that it and another robot as fast may come nearer in a tick.
    """

    slot: Slot
    floor: Floor
    up: Sequence[float]
    look: int
    speed: float
    since: int
    margin: float = 0.0


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
        self._extent = {index: self._outline(world.slots[index]) for index in self._able}
        self._state = np.empty(mujoco.mj_stateSize(model, _STATE))
        self._step = model.opt.timestep
        self.reset()

    @staticmethod
    def _is_able(slot: Slot) -> bool:
        return len(slot.feet) == 4

    def _reach(self, slot: Slot) -> float:
        """Metres from the origin of a robot to its outermost foot, seen from above."""
        places = self._world.model.geom_pos[slot.feet]
        return float(np.hypot(places[:, 0], places[:, 1]).max())

    def _outline(self, slot: Slot) -> float:
        """Metres from the origin of a robot to its outermost point; 0 for one that takes no long steps."""
        model = self._world.model
        if np.abs(model.body_ipos[slot.body, :2]).max() > _CENTRED:
            return 0.0
        geoms = self._geoms(slot)
        return float((np.linalg.norm(model.geom_pos[geoms], axis=1) + model.geom_rbound[geoms]).max())

    @staticmethod
    def _geoms(slot: Slot) -> list[int]:
        return [*(geom for geoms in slot.geoms.values() for geom in geoms), *slot.feet]

    def reset(self) -> None:
        """Nobody glides; the model is as it was compiled."""
        self._glides: dict[int, _Glide] = {}
        self._stands: dict[int, _Stand] = {}
        self._tick = 0
        self._look = 0
        self._newest = 0
        self._lopsided: set[int] = set()
        self._strides = False
        self._stride_at, self._stride_wait = 0, _WAIT

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
        soles = self._soles(slot)
        x, y, _ = world.positions[index]
        for floor in self._floors:
            if floor.slot in world.loose or floor.room(x, y) < self._able[index] + 2 * _EDGE:
                continue
            gaps = soles - floor.height
            if gaps.min() > -_NEAR and gaps.max() <= 0.0 and world.model.geom_contype[floor.geom]:
                return floor
        return None

    def _soles(self, slot: Slot) -> NDArray[np.float64]:
        """(4,) heights of the undersides of the feet, m."""
        return np.asarray(self._world.data.geom_xpos[slot.feet, 2] - self._world.model.geom_size[slot.feet, 0])

    def _touches_else(self, index: int, floor: Floor) -> bool:
        data = self._world.data
        pairs = data.contact.geom[: data.ncon]
        own = self._owner[pairs] == index
        expected = np.isin(pairs, self._world.slots[index].feet).any(axis=1) & (pairs == floor.geom).any(axis=1)
        return bool((own.any(axis=1) & ~expected).any())

    def _begin(self, index: int, slot: Slot, floor: Floor, command: Command) -> None:
        model = self._world.model
        # what lies lower than its feet cannot be met either
        mask = ALL_BITS & ~floor.bit
        lowest = float(self._soles(slot).min()) - _CLEAR
        for other in self._floors:
            if other.height < lowest and other.slot not in self._world.loose:
                mask &= ~other.bit
        for geom in self._geoms(slot):
            if model.geom_contype[geom]:
                model.geom_contype[geom] = model.geom_conaffinity[geom] = mask
        model.body_gravcomp[slot.body] = 1.0
        self._glides[index] = glide = _Glide(slot, floor, self._world.rotations[index][6:9], 0, 0.0, self._tick)
        self._plan(index, glide, math.hypot(command.linear[0], command.linear[1]))
        self._strides = False
        # how far it gets in a tick is known from the next command on
        self._newest = self._tick
        if not self._extent[index]:
            self._lopsided.add(index)
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
        self._lopsided.discard(index)
        self._stand(glide.slot)

    def _stand(self, slot: Slot) -> None:
        model = self._world.model
        for geom in self._geoms(slot):
            if model.geom_contype[geom]:
                model.geom_contype[geom] = model.geom_conaffinity[geom] = ALL_BITS
        model.body_gravcomp[slot.body] = 0.0
        self._set_margin(slot, 0.0)

    def _set_margin(self, slot: Slot, margin: float) -> None:
        """Have the engine notice what is so near, without pushing it."""
        model = self._world.model
        geoms = self._geoms(slot)
        model.geom_margin[geoms] = model.geom_gap[geoms] = margin
        model.body_margin[slot.body] = margin

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
            if glide.look <= self._tick:
                return False
        nearer = 2.0 * (speed + abs(wz) * self._extent[index]) * self._world.period
        if nearer > glide.margin:
            glide.margin = 1.5 * nearer
            if self._strides:
                self._set_margin(glide.slot, glide.margin)
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

    def step(self) -> None:
        """Let the engine take the steps of a tick."""
        world = self._world
        model, data = world.model, world.data
        if not self._glides:
            mujoco.mj_step(model, data, world.steps)
            return
        mujoco.mj_getState(model, data, self._state, _STATE)
        data.maxuse_con = 0
        if self._can_stride() and self._stride():
            return
        mujoco.mj_step(model, data, world.steps)
        while self._take_back():
            mujoco.mj_step(model, data, world.steps)

    # -- long steps ------------------------------------------------------------------------

    def _can_stride(self) -> bool:
        can = (
            self._tick >= self._stride_at
            and self._world.data.nv_awake == 6 * len(self._glides)
            and self._tick > self._newest
            and not self._lopsided
        )
        if can != self._strides:
            self._strides = can
            for glide in self._glides.values():
                self._set_margin(glide.slot, glide.margin if can else 0.0)
        return can

    def _stride(self) -> bool:
        """Try one step as long as the tick; False, and all as before, if something is near or wakes up."""
        world = self._world
        model, data = world.model, world.data
        model.opt.timestep = self._step * world.steps
        mujoco.mj_step(model, data)
        model.opt.timestep = self._step
        alone = data.nv_awake == 6 * len(self._glides)
        if alone and data.ncon:
            near = set(self._owner[data.contact.geom[: data.ncon]].ravel().tolist())
            alone = not any(index in near for index in self._glides)
        if alone:
            return True
        mujoco.mj_setState(model, data, self._state, _STATE)
        data.maxuse_con = 0
        self._strides = False
        for glide in self._glides.values():
            self._set_margin(glide.slot, 0.0)
        if self._tick - self._stride_at > _LONGEST_WAIT:
            self._stride_wait = _WAIT
        self._stride_at = self._tick + self._stride_wait
        self._stride_wait = min(2 * self._stride_wait, _LONGEST_WAIT)
        return False

    # -- what happens within a tick ----------------------------------------------------------

    def _take_back(self) -> bool:
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

    def all_stand(self) -> None:
        """Have the engine see the feet that glide; whoever calls it takes the change of the model back."""
        for glide in self._glides.values():
            self._stand(glide.slot)

    def supports(self) -> list[tuple[int, int]]:
        """The contacts that are not solved: pairs of geoms, foot and floor."""
        return [(foot, glide.floor.geom) for glide in self._glides.values() for foot in glide.slot.feet]


def _is_flat(command: Command) -> bool:
    """Whether a command moves a robot along the floor only."""
    return not (command.linear[2] or command.angular[0] or command.angular[1])
