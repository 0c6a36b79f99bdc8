"""Carries out the velocity commands of a tick."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from morse.physics import rigid
from morse.physics.casters import is_caster
from morse.physics.compile import set_damping
from morse.physics.drive import Command, midway
from morse.physics.layout import Motion

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from morse.physics.compile import Slot
    from morse.physics.world import World

_SIX = np.arange(6)
_AT_REST = ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))


class Drives:
    """The commands that hold during the tick to come.

    Velocities are written once a tick. So that the floor does not eat a part of them within
    the tick, a body that is driven slides without friction or damping, unless its script named
    a friction; told to stand still, it stands as any other body does.
    """

    def __init__(self, world: World) -> None:
        self._world = world
        self._commands: dict[int, Command] = {}
        self._sliding: set[int] = set()
        self._turn_after: list[tuple[int, float, bool]] = []
        self._kinematic: dict[int, tuple[Sequence[float], Sequence[float]]] = {}

    def reset(self) -> None:
        """Forget everything; the model is as it was compiled."""
        self._sliding.clear()
        self._commands.clear()
        self._kinematic.clear()
        self._turn_after.clear()

    def command(self, index: int, command: Command) -> None:
        """Have a slot move so during the next tick; the last command wins."""
        self._commands[index] = command

    def cancel(self, index: int) -> None:
        """Take the command of a slot back."""
        self._commands.pop(index, None)

    def kinematic_velocity(self, index: int) -> tuple[Sequence[float], Sequence[float]]:
        """Linear and angular velocity, in world axes, of a slot that the engine does not move."""
        return self._kinematic.get(index, _AT_REST)

    def apply(self) -> None:
        """The tick begins: write the velocities."""
        commands = self._commands
        slots, gliding = self._world.slots, self._world.gliding
        self._kinematic.clear()
        gliding.look()
        for index in [index for index in self._sliding if index not in commands]:
            self._set_sliding(index, False)
        gliders = []
        for index, command in commands.items():
            slot = slots[index]
            if index in gliding:
                if gliding.may_go_on(index, command):
                    gliders.append((index, slot, command))
                    continue
                gliding.leave(index)
            if slot.frame.motion is Motion.FREE and slot.dof >= 0:
                self._drive_body(index, slot, command)
            else:
                self._move(index, command)
        if gliders:
            self._glide(gliders)

    def _glide(self, gliders: list[tuple[int, Slot, Command]]) -> None:
        """Write the velocities of robots that glide: the vertical is an axis of the world, all else follows."""
        world = self._world
        rotations, half_period = world.rotations, 0.5 * world.period
        speeds, dofs = [], []
        for index, slot, command in gliders:
            r = rotations[index]
            x, y, _ = command.linear
            rate = command.angular[2]
            half = rate * half_period
            if half > 1e-9 or half < -1e-9:
                c, s = math.cos(half), math.sin(half)
                chord = s / half
                x, y = chord * (c * x - s * y), chord * (s * x + c * y)
            rate *= r[8]
            speeds.append((r[0] * x + r[1] * y, r[3] * x + r[4] * y, 0.0, r[6] * rate, r[7] * rate, r[8] * rate))
            dofs.append(slot.dof)
            if rate or command.shift:
                self._turn_after.append((slot.dof, half, command.shift))
        if len(dofs) == 1:
            world.data.qvel[dofs[0] : dofs[0] + 6] = speeds[0]
        else:
            world.data.qvel[np.array(dofs)[:, None] + _SIX] = speeds

    def _drive_body(self, index: int, slot: Slot, command: Command) -> None:
        sliding = not command.is_rest and (command.shift or slot.frame.node.body.friction is None)
        if sliding != (index in self._sliding):
            self._set_sliding(index, sliding)
        world = self._world
        r = world.rotations[index]
        a = slot.dof
        qvel = world.data.qvel
        vx, vy, vz = rigid.turn(r, midway(command.linear, command.angular, world.period))
        wx, wy, wz = command.angular
        if command.ground:
            old = qvel[a + 3 : a + 6].tolist()
            # the yaw rate of the world changes; roll and pitch rates stay: w' = w + R^T z (target - z.R w)
            change = r[6] * wx + r[7] * wy + r[8] * wz - (r[6] * old[0] + r[7] * old[1] + r[8] * old[2])
            qvel[a] = vx
            qvel[a + 1] = vy
            qvel[a + 3 : a + 6] = (old[0] + r[6] * change, old[1] + r[7] * change, old[2] + r[8] * change)
        elif command.shift:
            self._shift(qvel, a, (vx, vy, vz), command)
        else:
            qvel[a : a + 6] = (vx, vy, vz, wx, wy, wz)
        if command.shift or wz:
            self._turn_after.append((a, wz * world.period * 0.5, command.shift))
        if sliding and command.ground:
            world.gliding.consider(index, command)

    def _shift(self, qvel: Sequence[float], a: int, velocity: Sequence[float], command: Command) -> None:
        # axes that the command leaves alone stay with gravity and contacts
        qvel[a], qvel[a + 1] = velocity[0], velocity[1]  # type: ignore[index]
        if velocity[2]:
            qvel[a + 2] = velocity[2]  # type: ignore[index]
        for axis in range(3):
            if command.angular[axis] or axis == 2:
                qvel[a + 3 + axis] = command.angular[axis]  # type: ignore[index]

    def _move(self, index: int, command: Command) -> None:
        world = self._world
        position, rotation = world.positions[index], world.rotations[index]
        period = world.period
        step = rigid.turn(rotation, midway(command.linear, command.angular, period))
        wx, wy, wz = command.angular
        turned = rigid.product(rotation, rigid.rotation_of_vector((wx * period, wy * period, wz * period)))
        moved = (position[0] + step[0] * period, position[1] + step[1] * period, position[2] + step[2] * period)
        world.place(index, moved, turned)
        self._kinematic[index] = (rigid.turn(turned, command.linear), rigid.turn(turned, command.angular))

    def release(self) -> None:
        """The tick ends: a shift leaves no momentum, a velocity points along the new heading."""
        qvel = self._world.data.qvel
        if len(self._turn_after) > 3:
            self._turn_many(qvel)
        else:
            for a, angle, shift in self._turn_after:
                if shift:
                    qvel[a], qvel[a + 1], qvel[a + 5] = 0.0, 0.0, 0.0
                else:
                    vx, vy = qvel[a], qvel[a + 1]
                    c, s = math.cos(angle), math.sin(angle)
                    qvel[a], qvel[a + 1] = c * vx - s * vy, s * vx + c * vy
        self._turn_after.clear()
        self._commands.clear()

    def _turn_many(self, qvel: NDArray[np.float64]) -> None:
        dofs, angles, shifts = (np.array(column) for column in zip(*self._turn_after, strict=True))
        vx, vy = qvel[dofs], qvel[dofs + 1]
        c, s = np.cos(angles), np.sin(angles)
        qvel[dofs], qvel[dofs + 1] = c * vx - s * vy, s * vx + c * vy
        if shifts.any():
            halted = dofs[shifts]
            qvel[halted] = qvel[halted + 1] = qvel[halted + 5] = 0.0

    def _set_sliding(self, index: int, sliding: bool) -> None:
        world = self._world
        slot = world.slots[index]
        model = world.model
        if sliding:
            self._sliding.add(index)
            model.dof_damping[slot.dof : slot.dof + 6] = 0.0
        else:
            self._sliding.discard(index)
            world.gliding.leave(index)
            set_damping(model, slot)
        fixed = slot.frame.node.body.friction is not None
        for node, geoms in slot.geoms.items():
            if not is_caster(node):
                self._set_contact(geoms, sliding, fixed or node.body.friction is not None)
        self._set_contact(slot.feet, sliding, fixed)

    def _set_contact(self, geoms: Sequence[int], sliding: bool, fixed: bool) -> None:
        model = self._world.model
        for geom in geoms:
            model.geom_condim[geom] = 1 if sliding else 3
            model.geom_priority[geom] = 2 if sliding else int(fixed)
