"""Driven robots that glide over a level floor.

A driven robot slides without friction. While all its feet stand on one level floor and no other body touches it, the
floor only carries its weight: its height and tilt are constant, and it moves with its horizontal velocity. The contacts
of its feet then need not be solved. The robot is made weightless, and its collisions with that floor are disabled. This
saves most of the time of a tick.

`morse.physics.gliding.passage` moves these robots, and detects what they touch. Whether a robot glides depends on that
robot alone, and on what it touches.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, cast

import mujoco
import numpy as np

from morse.mathutils.portable import matmul
from morse.physics.engine_functions import WIDE_AWAKE
from morse.physics.gliding.floors import Floor, find_floors
from morse.physics.gliding.stances import FORESIGHT, Glide, Stances
from morse.physics.model.shapes import ALL_BITS, OF_FILE
from morse.physics.poses.kinematics import contact_pairs

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import NDArray

    from morse.physics.driving.command import Command
    from morse.physics.model.layout import Slot
    from morse.physics.state.engine_state import EngineState
    from morse.physics.state.saved import SavedGliding
    from morse.scene import Node

#: change of the tilt of a gliding robot since it began to glide
_TILTED = 1e-7
#: largest distance between feet and a floor that carries them, m; bodies penetrate floors slightly
_NEAR = 2e-3
#: shapes that are lower than the feet by more than this, m, cannot be touched
_CLEAR = 1e-6
#: interval of checks of the tilt, ticks, because a body that turns about a tilted axis begins to tumble
_LOOK = 300
#: speed plus turning rate, m/s and rad/s, above which a robot does not glide: far below those of a body that diverges
_FASTEST = 200.0
#: smallest margin of `Glide`, m
_LEAST = 1e-9
#: distance to the edge of the floor at which gliding ends, m
_EDGE = 0.01


class Gliding:
    """The gliding robots of a world.

    Attributes:
        floors: the level floors of the world.
        glides: the gliding robots, by slot.
        stances: stances of the other robots.
        owner: (G,) slot of each geom of a robot that may glide; K for other geoms.
        arrangement: changes whenever `glides` changes.
        tick: number of the present tick.
        speeds, margins: (K + 1,) values of `Glide` by slot; the speed is negative for slots that do not glide.
        extents: (K,) distance from the origin of a robot to its outermost point, by slot, m.
        clear_until: before that tick no robot can touch anything, unless something else moves.
        next_look: first tick in which one of the robots could be near an edge.
    """

    def __init__(self, state: EngineState) -> None:
        self._state = state
        model = state.model
        self._able = {index: self._reach(slot) for index, slot in enumerate(state.slots) if self._is_able(slot)}
        self.floors = find_floors(state) if self._able or state.planes else []
        touching, of_file = model.geom_contype != 0, (model.geom_contype & OF_FILE) != 0
        bits = np.where(touching, ALL_BITS, 0).astype(np.int32)
        for floor in self.floors:
            bits[floor.geom] = floor.bit
        self._kinds = np.where(of_file, model.geom_contype, bits)
        self._partners = np.where(of_file, model.geom_conaffinity, bits)
        model.geom_contype[:], model.geom_conaffinity[:] = self._kinds, self._partners
        count = len(state.slots)
        self.owner = np.full(model.ngeom, count)
        for index in self._able:
            self.owner[self._geoms(state.slots[index])] = index
        self._is_foot, self._is_floor = np.zeros(model.ngeom, dtype=bool), np.zeros(model.ngeom, dtype=bool)
        for index in self._able:
            self._is_foot[state.slots[index].feet] = True
        self._is_floor[[floor.geom for floor in self.floors]] = True
        #: slots that cannot glide because of their contacts in that tick
        self._busy_tick, self._busy = -1, set[int]()
        self._unmeasured: set[int] = set()
        #: shapes that have moved within robots, and the height of the lowest one above the origin of its robot, m
        self._moved: dict[int, set[int]] = {}
        self._lowest: dict[int, float] = {}
        self.extents = np.zeros(count)
        # single numbers are read through a memory view in a third of the time that an array takes
        self._extents = cast("memoryview[float]", self.extents.data)
        self._period = state.period
        self.stances = Stances(self._able, count)
        self.speeds, self.margins = np.zeros(count + 1), np.zeros(count + 1)
        self.glides: dict[int, Glide] = {}
        self.arrangement = 0
        self.reset()

    @staticmethod
    def _is_able(slot: Slot) -> bool:
        return len(slot.feet) == 4 and not slot.frame.carries

    def _reach(self, slot: Slot) -> float:
        """Return the horizontal distance from the origin of a robot to its outermost foot, m."""
        places = self._state.model.geom_pos[slot.feet]
        return float(np.hypot(places[:, 0], places[:, 1]).max())

    def note_moved_shapes(self, index: int, geoms: Iterable[int]) -> None:
        """Record that shapes have moved within a body, which changes its outline."""
        self._unmeasured.add(index)
        self._moved.setdefault(index, set()).update(geoms)
        self._lowest.pop(index, None)

    def forget_moved_shapes(self) -> None:
        """Record that all shapes are at their compiled poses."""
        self._moved.clear()
        self._lowest.clear()

    def goes_on(self, index: int, geoms: Iterable[int], reach: float, lowest: float) -> bool:
        """Record that shapes have moved within a body; return whether it continues to glide: none is near the floor.

        See `morse.physics.bodies.Bodies.shapes_have_moved`.
        """
        self.note_moved_shapes(index, geoms)
        self._lowest[index] = lowest
        glide = self.glides.get(index)
        if glide is None:
            return False
        if self._state.positions[index][2] + lowest < glide.floor.height + _NEAR:
            self.leave(index)
            return False
        self._unmeasured.discard(index)
        self.extents[index] = reach
        self.clear_until = 0
        return True

    def _hangs_low(self, index: int, floor: Floor) -> bool:
        """Whether a shape that has moved within a robot is near the floor, where gliding robots do not collide."""
        if index not in self._moved:
            return False
        if index not in self._lowest:
            model, data = self._state.model, self._state.data
            heights = []
            for geom in self._moved[index]:
                up, box = data.geom_xmat[geom, 6:9], model.geom_aabb[geom]
                heights.append(float(data.geom_xpos[geom, 2] + matmul(up, box[:3]) - matmul(np.abs(up), box[3:])))
            self._lowest[index] = min(heights) - self._state.positions[index][2]
        return self._state.positions[index][2] + self._lowest[index] < floor.height + _NEAR

    def _measure(self, index: int) -> None:
        """Compute the distance from the origin of a robot to its outermost point."""
        model, geoms = self._state.model, self._geoms(self._state.slots[index])
        self.extents[index] = (np.linalg.norm(model.geom_pos[geoms], axis=1) + model.geom_rbound[geoms]).max()
        self._unmeasured.discard(index)

    @staticmethod
    def _geoms(slot: Slot) -> list[int]:
        return [*(geom for geoms in slot.geoms.values() for geom in geoms), *slot.feet]

    def reset(self) -> None:
        """End all gliding, after the model was reset to its compiled values."""
        for glide in self.glides.values():
            self._set_gap(glide.slot, 0.0)
        self.glides.clear()
        self.arrangement += 1
        self.stances.reset()
        self.tick = self.next_look = self.clear_until = 0
        self._busy_tick = -1
        self.forget_moved_shapes()
        self.speeds[:] = -1.0
        self.margins[:] = 0.0
        for index in self._able:
            self._measure(index)

    # -- masks -----------------------------------------------------------------------------

    def set_collision(self, geoms: Iterable[int], active: bool) -> None:
        """Enable or disable the collisions of shapes."""
        model = self._state.model
        for geom in geoms:
            model.geom_contype[geom] = (self._kinds[geom] or ALL_BITS) if active else 0
            model.geom_conaffinity[geom] = (self._partners[geom] or ALL_BITS) if active else 0

    # -- gliding robots ------------------------------------------------------------------------

    @property
    def slots(self) -> Iterable[int]:
        """The indices of the gliding slots."""
        return self.glides.keys()

    def __contains__(self, index: int) -> bool:
        return index in self.glides

    def consider(self, index: int, command: Command) -> None:
        """Let a robot that is driven over the ground in this tick glide if possible."""
        if index not in self._able:
            return
        state = self._state
        height, up = state.positions[index][2], state.rotations[index][6:9]
        if self.stances.record(index, self.tick, height, up):
            self.consider_settled(index, command)

    def consider_settled(self, index: int, command: Command) -> None:
        """Let a robot that is driven over the ground and has settled glide if possible."""
        if (
            not _is_flat(command)
            or not math.hypot(*command.linear) + abs(command.angular[2]) <= _FASTEST
            or index in self._touching_else()
        ):
            return
        state = self._state
        slot = state.slots[index]
        if state.data.xfrc_applied[slot.body].any() or state.model.body_gravcomp[slot.body]:
            return
        floor = self._floor_under(index, slot)
        if floor is not None and not self._hangs_low(index, floor) and not self._touches_else(index, floor):
            self._begin(index, slot, floor, command)

    def _floor_under(self, index: int, slot: Slot) -> Floor | None:
        """Return the floor on which all feet stand, away from its edge, or None."""
        state = self._state
        soles = self._soles(slot)
        x, y, _ = state.positions[index]
        for floor in self.floors:
            if floor.slot in state.loose or floor.room(x, y) < self._able[index] + 2 * _EDGE:
                continue
            gaps = soles - floor.height
            if gaps.min() > -_NEAR and gaps.max() <= 0.0 and state.model.geom_contype[floor.geom]:
                return floor
        return None

    def _soles(self, slot: Slot) -> NDArray[np.float64]:
        """Return (4,) heights of the undersides of the feet, m."""
        return np.asarray(self._state.data.geom_xpos[slot.feet, 2] - self._state.model.geom_size[slot.feet, 0])

    def _touching_else(self) -> set[int]:
        """Return the slots with contacts other than those of their feet with a floor."""
        if self._busy_tick != self.tick:
            pairs = contact_pairs(self._state)
            pairs = np.concatenate([pairs, pairs[:, ::-1]])
            on_floor = self._is_foot[pairs[:, 0]] & self._is_floor[pairs[:, 1]]
            self._busy_tick, self._busy = self.tick, set(self.owner[pairs[~on_floor, 0]].tolist())
        return self._busy

    def _touches_else(self, index: int, floor: Floor) -> bool:
        """Whether a robot that only touches floors also touches another robot."""
        pairs = contact_pairs(self._state)
        own = np.isin(pairs, self._state.slots[index].feet).any(axis=1)
        return bool((own & ~(pairs == floor.geom).any(axis=1)).any())

    def _lift(self, glide: Glide) -> None:
        """Disable gravity and collisions with the floor for a robot."""
        model, slot, floor = self._state.model, glide.slot, glide.floor
        # shapes lower than the feet of the robot cannot be touched either
        mask = ALL_BITS & ~floor.bit
        lowest = float(self._soles(slot).min()) - _CLEAR
        for other in self.floors:
            if other.height < lowest and other.slot not in self._state.loose:
                mask &= ~other.bit
        for geom in self._geoms(slot):
            if model.geom_contype[geom]:
                model.geom_contype[geom] = model.geom_conaffinity[geom] = mask
        model.body_gravcomp[slot.body] = 1.0

    def _begin(self, index: int, slot: Slot, floor: Floor, command: Command) -> None:
        if index in self._unmeasured:
            self._measure(index)
        glide = Glide(slot, floor, self._state.rotations[index][6:9], 0, 0.0, self.tick)
        speed = math.hypot(command.linear[0], command.linear[1])
        self._plan(index, glide, speed)
        if glide.look <= self.tick:
            self.speeds[index] = -1.0
            return
        self.glides[index] = glide
        self.arrangement += 1
        self._lift(glide)
        self._widen(index, glide, 2.0 * (speed + abs(command.angular[2]) * self._extents[index]) * self._period)
        self._start_anew(slot)

    def _plan(self, index: int, glide: Glide, speed: float) -> None:
        """Compute the first tick in which the robot could be near an edge."""
        x, y, _ = self._state.positions[index]
        room = glide.floor.room(x, y) - self._able[index] - _EDGE
        glide.speed = self.speeds[index] = max(2.0 * speed, 0.1)
        ticks = math.floor(room / (glide.speed * self._state.period)) if room > 0.0 else 0
        glide.look = self.tick + min(ticks, _LOOK)
        self.next_look = min(self.next_look, glide.look) if self.glides.keys() - {index} else glide.look

    def unsettle(self, index: int) -> None:
        """End the gliding of a robot that was moved by an explicit call; it has to settle before it glides again."""
        self.stances.unsettle(index)
        self.leave(index)

    def leave(self, index: int) -> None:
        """End the gliding of a robot."""
        glide = self.glides.pop(index, None)
        if glide is None:
            return
        self.arrangement += 1
        self.speeds[index], self.margins[index] = -1.0, 0.0
        self._stand(glide.slot)
        self._start_anew(glide.slot)
        self._turn_as_engine(index, glide.slot)

    def _turn_as_engine(self, index: int, slot: Slot) -> None:
        """Set the rotation of a robot as the engine computes it; its last bits may be others than those of the kernel.

        A saved state does not tell who has computed it: of robots that do not glide, it is the engine.
        """
        quaternion, rotation = self._state.data.qpos[slot.qpos + 3 : slot.qpos + 7].copy(), np.empty(9)
        mujoco.mju_normalize4(quaternion)
        mujoco.mju_quat2Mat(rotation, quaternion)
        self._state.rotations[index] = tuple(rotation.tolist())

    def _stand(self, slot: Slot) -> None:
        model = self._state.model
        for geom in self._geoms(slot):
            if model.geom_contype[geom]:
                model.geom_contype[geom] = model.geom_conaffinity[geom] = ALL_BITS
        model.body_gravcomp[slot.body] = 0.0
        self._set_gap(slot, 0.0)

    def _start_anew(self, slot: Slot) -> None:
        """Remove what the engine keeps of a body from step to step."""
        data = self._state.data
        data.tree_asleep[self._state.model.body_treeid[slot.body]] = WIDE_AWAKE
        data.qacc_warmstart[slot.dof : slot.dof + 6] = 0.0

    def _widen(self, index: int, glide: Glide, travel: float) -> None:
        """Let the engine detect what a robot can reach in a number of ticks.

        Args:
            travel: twice the distance that the outermost point of the robot moves in a tick, m.
        """
        # a little more, so that a change of the command seldom changes the gap
        glide.margin = self.margins[index] = max(1.5 * travel, _LEAST)
        self._set_gap(glide.slot, glide.margin)
        self.clear_until = 0

    def set_gaps(self, active: bool) -> None:
        """Set the gaps around all robots, or remove them for some steps."""
        for glide in self.glides.values():
            self._set_gap(glide.slot, glide.margin if active else 0.0)

    def _set_gap(self, slot: Slot, margin: float) -> None:
        """Let the engine detect contacts without forces, at a distance that the robot does not reach in some ticks.

        Args:
            margin: see `Glide`; 0 to end that.
        """
        model = self._state.model
        self._state.has_gaps |= margin > 0.0
        model.geom_gap[self._geoms(slot)] = model.body_margin[slot.body] = 0.5 * FORESIGHT * margin

    def floor_changed(self, slot: int) -> None:
        """A static slot was moved, or its collisions were changed: robots on it end gliding, others may touch it."""
        self.clear_until = 0
        if any(floor.slot == slot for floor in self.floors):
            for index, glide in list(self.glides.items()):
                if glide.floor.slot == slot:
                    self.leave(index)
                else:
                    self._lift(glide)

    # -- a tick ----------------------------------------------------------------------------

    def may_go_on(self, index: int, command: Command) -> bool:
        """Whether a gliding robot can continue to glide with this command."""
        glide = self.glides[index]
        vx, vy, vz = command.linear
        wx, wy, wz = command.angular
        if vz or wx or wy or not (vx or vy or wz):
            return False
        speed = math.sqrt(vx * vx + vy * vy)
        if speed > glide.speed:
            self._plan(index, glide, speed)
            if glide.look <= self.tick:
                return False
        travel = 2.0 * (speed + abs(wz) * self._extents[index]) * self._period
        if travel > glide.margin:
            if not speed + abs(wz) <= _FASTEST:
                return False
            self._widen(index, glide, travel)
        return True

    def look(self) -> None:
        """Check the robots that could be near an edge, at the start of a tick."""
        self.tick += 1
        if self.glides and self.tick >= self.next_look:
            for index, glide in list(self.glides.items()):
                if glide.look <= self.tick:
                    self._look_at(index, glide)
            self.next_look = min((glide.look for glide in self.glides.values()), default=0)

    def _look_at(self, index: int, glide: Glide) -> None:
        up = self._state.rotations[index][6:9]
        if max(abs(a - b) for a, b in zip(up, glide.up, strict=True)) > _TILTED:
            self.leave(index)
            return
        self._plan(index, glide, glide.speed / 2.0)
        if glide.look <= self.tick:
            self.leave(index)

    def all_stand(self) -> None:
        """Enable the collisions of gliding feet in the engine. The caller restores the model."""
        for glide in self.glides.values():
            self._stand(glide.slot)

    def supports(self) -> list[tuple[int, int]]:
        """Return the contacts that are not solved: pairs of geoms, foot and floor."""
        return [(foot, glide.floor.geom) for glide in self.glides.values() for foot in glide.slot.feet]

    # -- other scenes ------------------------------------------------------------------------

    def floor_bits(self) -> dict[Node, dict[int, int]]:
        """Return for each node the bits of its shapes that are floors, by index of the shape."""
        bits: dict[Node, dict[int, int]] = {}
        for floor in self.floors:
            node = self._state.geom_node[floor.geom]
            bits.setdefault(node, {})[self._state.slots[floor.slot].geoms[node].index(floor.geom)] = floor.bit
        return bits

    def lift_all(self) -> None:
        """Restore the gliding of all gliding robots in a recompiled model."""
        self.clear_until = 0
        for glide in self.glides.values():
            self._lift(glide)

    # -- saving ------------------------------------------------------------------------------

    def get_state(self) -> dict[str, object]:
        """See `morse.physics.state.saved.SavedGliding`."""
        names = self._state.names
        return {
            "glides": [
                {
                    "slot": names[index],
                    "floor": glide.floor.bit,
                    "up": tuple(glide.up),
                    "look": glide.look,
                    "speed": glide.speed,
                    "since": glide.since,
                    "margin": glide.margin,
                }
                for index, glide in self.glides.items()
            ],
            "stands": self.stances.get_state(names),
            "tick": self.tick,
            "look": self.next_look,
        }

    def check_state(self, state: SavedGliding) -> None:
        """Raise ValueError if a state contains robots that cannot glide, or floors that do not exist."""
        bits = {floor.bit for floor in self.floors}
        for name in [*(glide.slot for glide in state.glides), *(stand.slot for stand in state.stands)]:
            if self._state.named[name] not in self._able:
                raise ValueError(f"'{name}' is not a robot that can glide")
        for glide in state.glides:
            if glide.floor not in bits or all(stand.slot != glide.slot for stand in state.stands):
                raise ValueError(f"there is no floor {glide.floor} for '{glide.slot}'")

    def set_state(self, state: SavedGliding) -> None:
        """Restore a validated state; the arrays of the model and the poses of parts are set before."""
        new_moved = dict(self._moved)
        self.reset()
        self._moved.update(new_moved)
        slots_by_name, slots = self._state.named, self._state.slots
        floors = {floor.bit: floor for floor in self.floors}
        for entry in state.glides:
            index = slots_by_name[entry.slot]
            slot = slots[index]
            self.glides[index] = glide = Glide(
                slot, floors[entry.floor], entry.up, entry.look, entry.speed, entry.since, entry.margin
            )
            self.speeds[index], self.margins[index] = entry.speed, entry.margin
            self._set_gap(slot, glide.margin)
        self.stances.set_state(state.stands, slots_by_name)
        self.tick, self.next_look = state.tick, state.look


def _is_flat(command: Command) -> bool:
    """Whether a command moves a robot only along the floor."""
    return not (command.linear[2] or command.angular[0] or command.angular[1])
