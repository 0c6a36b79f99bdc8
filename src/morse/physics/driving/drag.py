"""Losses of robots that are driven as one body: friction, if their script sets a friction.

If the scene has the physics of MORSE 1.4, all of them have the losses of `morse.physics.driving.calibration` instead.

A command sets the velocity of such a robot once a tick. In MORSE 1.4 friction then acted in each of the two physics
steps of the tick, so that a robot was slower than its command: by d in the first step and 2 d in the second, with d =
mu mu_floor g T/2. Scripts depend on that speed. Contact forces would also tip the robot over, because no force pushes
it forward at the height of the floor. Therefore the velocity is reduced instead, and the robot slides.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from morse.physics.driving.calibration import FLOOR, Slowdown
from morse.physics.driving.command import Command
from morse.physics.model.layout import Motion
from morse.physics.poses.kinematics import contact_pairs

if TYPE_CHECKING:
    from collections.abc import Collection

    from morse.physics.model.slot import Slot
    from morse.physics.state.engine_state import EngineState

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
