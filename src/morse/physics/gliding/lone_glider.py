"""The tick of a world in which one robot glides far from obstacles, and nothing else moves.

`World.step` calls every part of the physics. For a lone gliding robot most calls do nothing, but take longer than the
work. `LoneGlider.step` does the work of the parts in the same order, with bit-identical results: `Drives.apply` writes
the velocity, `GlideSteps` integrates it, and `Drives.release` rotates it to the new heading.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import mujoco

from morse.kernel.driving.turns import arc
from morse.physics.gliding import glide_velocity
from morse.physics.poses import kinematics

if TYPE_CHECKING:
    from collections.abc import Sequence

    from morse.physics.driving.command import Command
    from morse.physics.driving.drives import Drives
    from morse.physics.gliding.glide import Glide
    from morse.physics.gliding.gliding import Gliding
    from morse.physics.objects.attachments import Attachments
    from morse.physics.state.engine_state import EngineState

#: speeds, m/s and rad/s, above which each tick is checked for divergence
_CALM = 100.0
_NO_COMMAND = ((), (), None)


class LoneGlider:
    """Runs the tick of a lone glider.

    Args:
        is_plain: whether the world has neither wheels nor locked bodies, which take part in every tick.
    """

    def __init__(
        self, state: EngineState, gliding: Gliding, drives: Drives, attachments: Attachments, is_plain: bool
    ) -> None:
        self._state = state
        self._gliding = gliding
        self._drives = drives
        self._attachments = attachments
        self._is_plain = is_plain
        self._data, self._qpos, self._qvel = state.data, state.data.qpos, state.data.qvel
        self._period = state.model.opt.timestep * state.steps
        self._known: tuple[Sequence[float], Sequence[float], Glide | None] = _NO_COMMAND
        self._speed = self._nearer = math.inf
        self._chord = (0.0, 0.0, 1.0, 0.0)

    def step(self) -> bool:
        """Run the tick; return False without changes if another part of the physics has work to do."""
        state, gliding = self._state, self._gliding
        tick = gliding.tick + 1
        if tick >= gliding.clear_until or tick >= gliding.next_look or state.is_stirred or state.has_forces:
            # the outline of the robot may have changed
            self._known = _NO_COMMAND
            return False
        lone = self._drives.lone_command()
        if lone is None or not self._is_plain or self._attachments.are_busy:
            return False
        index, command = lone
        glide = gliding.glides.get(index)
        if glide is None or len(gliding.glides) != 1 or self._data.nv_awake != 6:
            return False
        if not self._may_go_on(index, glide, command):
            return False
        gliding.tick = tick
        self._drift(index, glide.slot.dof, command)
        self._drives.end_lone()
        state.kinematic.clear()
        state.known_contacts = None
        kinematics.sync(state)
        return True

    def _may_go_on(self, index: int, glide: Glide, command: Command) -> bool:
        """Whether `Gliding.may_go_on` would change nothing."""
        linear, angular, known = self._known
        if glide is not known or command.linear != linear or command.angular != angular:
            # a command is often equal for many ticks
            (x, y, z), (roll, pitch, rate) = command.linear, command.angular
            if z or roll or pitch or not (x or y or rate):
                return False
            speed = math.sqrt(x * x + y * y)
            if not speed + abs(rate) <= _CALM:
                return False
            self._known = command.linear, command.angular, glide
            self._speed = speed
            self._nearer = 2.0 * (speed + abs(rate) * self._gliding.extents[index]) * self._state.period
            self._chord = arc(x, y, 0.5 * rate * self._state.period)
        return self._speed <= glide.speed and self._nearer <= glide.margin

    def _drift(self, index: int, dof: int, command: Command) -> None:
        """Write the velocity, integrate it, and rotate it to the new heading."""
        qvel, rate = self._qvel, command.angular[2]
        x, y, c, s = self._chord
        glide_velocity.write(qvel, dof, self._state.rotations[index], x, y, rate)
        mujoco.mj_integratePos(self._state.model, self._qpos, qvel, self._period)
        self._data.time += self._period
        if rate != 0.0 or command.shift:
            glide_velocity.end(qvel, dof, c, s, command.shift)
