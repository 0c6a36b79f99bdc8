"""Executes the velocity commands of a tick."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from morse.kernel.driving import arc, turn_by
from morse.physics.driving.command import FLOOR, Command, Slowdown, midway, set_damping
from morse.physics.driving.supports import supports
from morse.physics.gliding import glide_velocity
from morse.physics.model.layout import Motion
from morse.physics.poses import rigid
from morse.physics.poses.kinematics import contact_pairs

if TYPE_CHECKING:
    from collections.abc import Collection, Sequence

    from numpy.typing import NDArray

    from morse.core.values import StateData
    from morse.kernel.driving import GliderWork
    from morse.physics.bodies import Bodies
    from morse.physics.driving.fleet import Fleet
    from morse.physics.gliding.gliding import Gliding
    from morse.physics.model.layout import Slot
    from morse.physics.state.engine_state import EngineState
    from morse.physics.state.saved import SavedDrives
    from morse.scene import Node

#: radius at which a robot without feet touches the floor, m
_REACH = 0.3


class Drag:
    """Slows down robots that are driven over the ground with friction.

    Attributes:
        slots: the slots with friction while they are driven.
    """

    def __init__(self, state: EngineState) -> None:
        self._state = state
        self._rough: dict[int, tuple[float, float, list[int]]] = {}
        self.slots: Collection[int] = self._rough.keys()
        self._slowdowns: dict[int, Slowdown] = {}
        #: velocities at the end of the present tick, relative to the mean ones: linear and angular, by slot
        self.ends: dict[int, tuple[float, float]] = {}
        gravity = -float(state.model.opt.gravity[2])
        for index, slot in enumerate(state.slots):
            body = slot.frame.node.body
            if slot.frame.robot is None or slot.frame.motion is not Motion.FREE:
                continue
            if body.friction or state.physics_of_1_4:
                geoms = [*(geom for geoms in slot.geoms.values() for geom in geoms), *slot.feet]
                self._rough[index] = (body.friction or 0.0, self._lever(slot), geoms)
            if state.physics_of_1_4:
                coefficient = slot.frame.node.properties.get("RollingFriction")
                rolling = coefficient if isinstance(coefficient, float) and 0.0 <= coefficient < math.inf else None
                self._slowdowns[index] = Slowdown.of(body, rolling, gravity, state.period)

    def _lever(self, slot: Slot) -> float:
        """Return the distance from the vertical axis of a robot to its contact with the floor, m."""
        if not slot.feet:
            return _REACH
        places = self._state.model.geom_pos[slot.feet]
        return float(np.hypot(places[:, 0], places[:, 1]).mean())

    def slowed(self, index: int, command: Command, touches: bool) -> Command:
        """Return a command reduced by friction, and by damping if the scene has the physics of 1.4.

        Args:
            touches: whether the robot is known to stand on something.
        """
        friction, lever, geoms = self._rough[index]
        if command.shift or command.is_rest:
            return command
        touches = touches or self._touches(geoms)
        if index in self._slowdowns:
            slowing = self._slowdowns[index].slow(command, touches)
            self.ends[index] = slowing.linear, slowing.angular
            return slowing.command
        if not touches:
            return command
        vx, vy, vz = command.linear
        wx, wy, wz = command.angular
        slip = math.hypot(vx, vy, wz * lever)
        loss = friction * FLOOR * -float(self._state.model.opt.gravity[2]) * self._state.period / 2.0
        if not slip or loss <= 0.0:
            return command
        share = (max(0.0, 1.0 - loss / slip) + max(0.0, 1.0 - 2.0 * loss / slip)) / 2.0
        return Command((vx * share, vy * share, vz), (wx, wy, wz * share), command.shift, command.ground)

    def _touches(self, geoms: list[int]) -> bool:
        return bool(np.isin(contact_pairs(self._state), geoms).any())


Six = tuple[float, float, float, float, float, float]


def body_velocity(
    r: Sequence[float],
    old: Sequence[float],
    linear: Sequence[float],
    angular: Sequence[float],
    ground: bool,
    shift: bool,
) -> Six:
    """The velocity of a driven body.

    Args:
        r: (9,) its rotation, row by row.
        old: (6,) its present velocity: linear in the axes of the world, angular in its own axes.
        linear, angular: the command in its own axes, m/s and rad/s.
        ground: keep the vertical speed, and the roll and pitch rates.
        shift: leave axes without a command to gravity and contacts.
    """
    x, y, z = linear
    wx, wy, wz = angular
    a, b, c, d, e, f, g, h, i = r
    vx, vy, vz = a * x + b * y + c * z, d * x + e * y + f * z, g * x + h * y + i * z
    if ground:
        # the yaw rate about the world Z axis changes; roll and pitch rates do not: w' = w + R^T z (target - z.R w)
        _, _, up, roll, pitch, yaw = old
        change = g * wx + h * wy + i * wz - (g * roll + h * pitch + i * yaw)
        return vx, vy, up, roll + g * change, pitch + h * change, yaw + i * change
    if shift:
        return vx, vy, vz or old[2], wx or old[3], wy or old[4], wz
    return vx, vy, vz, wx, wy, wz


class Drives:
    """The velocity commands for the next tick.

    Velocities are written once per tick. A driven body slides without friction or damping, so that the floor does not
    slow it down within the tick; if its script sets a friction, the command is reduced. With a command of zero, the
    robot has friction like any other body.
    """

    def __init__(self, state: EngineState, gliding: Gliding, bodies: Bodies) -> None:
        self._state = state
        self._gliding = gliding
        self._bodies = bodies
        self._drag = Drag(state)
        self._commands: dict[int, Command] = {}
        self._fleets: list[Fleet] = []
        self._sliding: set[int] = set()
        self._known_surfaces: dict[int, tuple[NDArray[np.intp], NDArray[np.intp]]] = {}
        count = len(state.slots)
        # sliding slots as an array, for fleets; and the slots whose commands are not changed by friction
        self._slides = np.zeros(count, dtype=np.uint8)
        self._plain = np.ones(count, dtype=np.uint8)
        self._plain[list(self._drag.slots)] = 0
        self._asleep = state.data.tree_asleep
        self._qvel = state.data.qvel
        self._turn_after: list[tuple[int, float, float, bool]] = []

    def reset(self) -> None:
        """Clear all commands, after the model was reset to its compiled values."""
        self._sliding.clear()
        self._slides[:] = 0
        self._commands.clear()
        self._fleets.clear()
        self._state.kinematic.clear()
        self._turn_after.clear()
        self._drag.ends.clear()

    def get_state(self) -> StateData:
        """See `morse.physics.state.saved.SavedDrives`."""
        names = self._state.names
        return {
            "commands": [
                {
                    "slot": names[index],
                    "linear": tuple(map(float, command.linear)),
                    "angular": tuple(map(float, command.angular)),
                    "shift": command.shift,
                    "ground": command.ground,
                }
                for index, command in self._all_commands().items()
            ],
            "sliding": [names[index] for index in sorted(self._sliding)],
        }

    def set_state(self, state: SavedDrives) -> None:
        """Restore a validated state; the arrays of the model are set elsewhere."""
        self.reset()
        slots_by_name = self._state.named
        self._sliding.update(slots_by_name[name] for name in state.sliding)
        self._slides[list(self._sliding)] = 1
        for entry in state.commands:
            self._commands[slots_by_name[entry.slot]] = Command(entry.linear, entry.angular, entry.shift, entry.ground)

    def command(self, index: int, command: Command) -> None:
        """Set the command of a slot for the next tick; the last command wins."""
        self._withdraw(index)
        self._commands[index] = command

    def command_of(self, index: int) -> Command | None:
        """Return the command of a slot that `command` has set for the next tick."""
        return self._commands.get(index)

    def command_fleet(self, fleet: Fleet) -> None:
        """Use the commands of a fleet in the next tick."""
        fleet.renew()
        if self._commands:
            for index in [index for index in self._commands if index in fleet.rows]:
                del self._commands[index]
        for other in self._fleets:
            if other is fleet:
                return
            for index in other.rows.keys() & fleet.rows.keys():
                other.withdraw(index)
        self._fleets.append(fleet)

    def _withdraw(self, index: int) -> None:
        for fleet in self._fleets:
            if index in fleet.rows:
                fleet.withdraw(index)

    def _all_commands(self) -> dict[int, Command]:
        commands = {index: command for fleet in self._fleets for index, command in fleet.commands().items()}
        return {**commands, **self._commands}

    @property
    def has_commands(self) -> bool:
        """Whether any slot has a command for the next tick."""
        return bool(self._commands or self._fleets)

    @property
    def has_work(self) -> bool:
        """Whether the part acts in the next ticks: gliding robots are looked at in all of them."""
        return True

    @property
    def is_idle(self) -> bool:
        """Whether no body has a command for the next tick or had one in the last tick."""
        return (
            not (self._commands or self._fleets or self._sliding or self._turn_after or self._drag.ends)
            and not self._state.kinematic
        )

    def is_commanded(self, index: int) -> bool:
        """Whether a slot has a command for the next tick."""
        return index in self._commands or any(index in fleet.rows for fleet in self._fleets)

    def cancel(self, index: int) -> None:
        """Remove the command of a slot."""
        self._withdraw(index)
        self._commands.pop(index, None)

    def before_step(self) -> None:
        """Write the velocities at the beginning of a tick."""
        commands, gliding = self._commands, self._gliding
        self._state.kinematic.clear()
        gliding.look()
        if not (commands or self._fleets or self._sliding):
            return
        if self._fleets:
            for fleet in self._fleets:
                commands.update(fleet.begin(self._state, gliding, self._plain, self._slides))
            stopped = list(self._sliding.difference(*(fleet.rows for fleet in self._fleets), commands))
        else:
            stopped = [index for index in self._sliding if index not in commands]
        for index in stopped:
            self._set_sliding(index, False)
        for fleet in self._fleets:
            fleet.settle(gliding)
        if commands:
            self._apply_each(commands)

    def _apply_each(self, commands: dict[int, Command]) -> None:
        slots, gliding = self._state.slots, self._gliding
        glides, rough = gliding.glides, self._drag.slots
        for index, command in commands.items():
            slot = slots[index]
            if rough and index in rough:
                command = self._drag.slowed(index, command, index in glides)
            if index in glides:
                if gliding.may_go_on(index, command):
                    self._glide(index, slot, command)
                    continue
                gliding.leave(index)
            if slot.frame.motion is Motion.FREE and slot.dof >= 0:
                if command.is_rest and not self._slides[index] and self._sleeps(slot):
                    continue
                self._drive_body(index, slot, command)
            else:
                self._move(index, command)

    def _sleeps(self, slot: Slot) -> bool:
        """Whether a body sleeps."""
        return bool(self._asleep[self._state.model.body_treeid[slot.body]] >= 0)

    def _glide(self, index: int, slot: Slot, command: Command) -> None:
        """Write the velocity of a robot that glides."""
        x, y, _ = command.linear
        rate = command.angular[2]
        x, y, c, s = arc(x, y, 0.5 * rate * self._state.period)
        if rate != 0.0 or command.shift:
            self._turn_after.append((slot.dof, c, s, command.shift))
        glide_velocity.write(self._qvel, slot.dof, self._state.rotations[index], x, y, rate)

    def _drive_body(self, index: int, slot: Slot, command: Command) -> None:
        self._state.is_stirred = True
        sliding = not command.is_rest
        if sliding != (index in self._sliding):
            self._set_sliding(index, sliding)
        state, dof = self._state, slot.dof
        linear, angular = command.linear, command.angular
        wx, wy, wz = angular
        half = 0.5 * wz * state.period
        if wx or wy:
            linear, (c, s) = midway(linear, angular, state.period), turn_by(half)
        else:
            x, y, c, s = arc(linear[0], linear[1], half)
            linear = (x, y, linear[2])
        rotation, old = state.rotations[index], glide_velocity.read(self._qvel, dof)
        velocity = body_velocity(rotation, old, linear, angular, command.ground, command.shift)
        glide_velocity.put(self._qvel, dof, velocity)
        if command.shift or wz:
            self._turn_after.append((dof, c, s, command.shift))
        if sliding and command.ground:
            self._gliding.consider(index, command)
        elif wx or wy:
            self._bodies.balance_spin(index, angular)

    def _move(self, index: int, command: Command) -> None:
        state = self._state
        position, rotation = state.positions[index], state.rotations[index]
        period = state.period
        step = rigid.turn(rotation, midway(command.linear, command.angular, period))
        wx, wy, wz = command.angular
        new_rotation = rigid.product(rotation, rigid.rotation_of_vector((wx * period, wy * period, wz * period)))
        new_position = (position[0] + step[0] * period, position[1] + step[1] * period, position[2] + step[2] * period)
        self._bodies.place(index, new_position, new_rotation)
        state.kinematic[index] = (rigid.turn(new_rotation, command.linear), rigid.turn(new_rotation, command.angular))

    def after_step(self) -> None:
        """Called at the end of a tick: remove the momentum of shifts, and turn velocities to the new heading."""
        if not (self._commands or self._fleets or self._turn_after or self._drag.ends):
            return
        for dof, c, s, shift in self._turn_after:
            glide_velocity.end(self._qvel, dof, c, s, shift)
        self._turn_after.clear()
        if self._drag.ends:
            self._slow_down()
        for fleet in self._fleets:
            fleet.end()
        self.clear()

    def clear(self) -> None:
        """Remove all commands: each holds for one tick."""
        self._commands.clear()
        self._fleets.clear()

    def only_fleet(self) -> GliderWork | None:
        """Return what drives a fleet, if no other body has a command for the next tick or had one in the last tick."""
        if len(self._fleets) != 1 or self._commands or self._turn_after or self._drag.ends:
            return None
        fleet = self._fleets[0]
        return None if fleet.is_partial or self._sliding.difference(fleet.rows) else fleet.work_of(self._state)

    def _slow_down(self) -> None:
        """Set the velocities that losses within the tick leave at its end."""
        for index, (linear, angular) in self._drag.ends.items():
            dof = self._state.slots[index].dof
            across, about = (2, 5) if self._commands[index].ground else (3, 3)
            self._qvel[dof : dof + across] *= linear
            self._qvel[dof + about : dof + 6] *= angular
        self._drag.ends.clear()

    def _set_sliding(self, index: int, sliding: bool) -> None:
        state = self._state
        slot = state.slots[index]
        model = state.model
        self._slides[index] = sliding
        if sliding:
            self._sliding.add(index)
            model.dof_damping[slot.dof : slot.dof + 6] = 0.0
        else:
            self._sliding.discard(index)
            self._gliding.leave(index)
            set_damping(model, slot, state.physics_of_1_4)
        geoms, priorities = self._surfaces(index, slot)
        model.geom_condim[geoms] = 1 if sliding else 3
        model.geom_priority[geoms] = 3 if sliding else priorities

    def _surfaces(self, index: int, slot: Slot) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        """Return the shapes of a robot that lose their friction while it slides, and their priorities at rest."""
        surfaces = self._known_surfaces.get(index)
        if surfaces is None:
            state = self._state
            fixed = slot.frame.node.body.friction is not None or state.physics_of_1_4
            casters = supports(slot.frame)
            shapes = [(geoms, node) for node, geoms in slot.geoms.items() if node not in casters]
            shapes += [part for link in state.links.get(index, ()) for part in _shapes(state.slots[link])]
            rows = [(geom, 2 * (fixed or node.body.friction is not None)) for geoms, node in shapes for geom in geoms]
            rows += [(foot, 2 * fixed) for foot in slot.feet]
            table = np.array(rows, dtype=np.intp).reshape(-1, 2)
            surfaces = self._known_surfaces[index] = table[:, 0].copy(), table[:, 1].copy()
        return surfaces


def _shapes(slot: Slot) -> list[tuple[list[int], Node]]:
    return [(geoms, node) for node, geoms in slot.geoms.items()]
