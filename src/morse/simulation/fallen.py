"""Warns about robots that fall below the world."""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING
from weakref import WeakSet

from morse.physics.model.fixed_bottom import lowest_fixed

if TYPE_CHECKING:
    from morse.core.robot import Robot
    from morse.simulation.simulation import Simulation

logger = logging.getLogger(__name__)

#: ticks between two checks, and robots of one check: the checks take less than 1 % of a tick
_INTERVAL, _ROBOTS = 30, 16
#: depth below everything that stands still, m, and speed of a fall, m/s
_BELOW, _FALLING = 2.0, 1.0


class Fallen:
    """Names each robot once that has moved over the edge of its world, or that nothing carries."""

    def __init__(self, simulation: Simulation) -> None:
        self._simulation = simulation
        self._reports: WeakSet[Robot] = WeakSet()
        self._first = self._next = 0
        self._bottom: float | None = None

    def review(self, tick: int, changed: bool) -> int:
        """Check some robots; see `morse.simulation.ticks.ticking.Ticker.reviews`."""
        if changed:
            self._bottom, self._next = None, tick
        if tick < self._next:
            return self._next
        self._next = tick + _INTERVAL
        robots = self._simulation.loaded.robots
        if self._first >= len(robots):
            self._first = 0
        for robot in robots[self._first : self._first + _ROBOTS]:
            self._check(robot)
        self._first += _ROBOTS
        return self._next

    def _check(self, robot: Robot) -> None:
        body = robot.bge_object
        if robot in self._reports or body.velocity()[0][2] > -_FALLING:
            return
        height = body.world_pose()[0][2]
        if self._bottom is None:
            self._bottom = lowest_fixed(self._simulation.world)
        below = self._bottom - height
        if below < _BELOW:
            return
        self._reports.add(robot)
        environment = self._simulation.scene.environment
        logger.warning(
            "%s falls: it is at z = %.1f m, %s; F11 or the service simulation.reset begins again",
            robot.name(),
            height,
            f"below the floor of '{environment}'" if below < float("inf") else f"and '{environment}' has no floor",
        )
