"""Reviews between ticks: robots that leave the world, and data that do not match their declarations."""

from __future__ import annotations

import logging
import math
from typing import TYPE_CHECKING
from weakref import WeakSet

from morse.core.exceptions import MorseError
from morse.core.guard import Failure
from morse.core.hidden_methods import uncover
from morse.core.sensor import misfits
from morse.physics.model.placement import bottom_of, lowest_shape

if TYPE_CHECKING:
    from morse.core.declarations import DataField
    from morse.core.object import Object
    from morse.core.robot import Robot
    from morse.simulation.simulation import Simulation


# Robots that leave the world: they fall below everything.

logger = logging.getLogger(__name__)

#: ticks between two checks, and robots of one check: the checks take less than 1 % of a tick
_INTERVAL, _ROBOTS = 30, 16
#: depth below everything, m, and the least speed as a share of that of a free fall to this depth: robots that fly or
#: dive are slower
_BELOW, _SHARE = 10.0, 0.5


class FallenError(MorseError):
    """A robot has left the world, in a scene with ``Environment(fallen="error")``."""


class Fallen:
    """Reports each robot once that has moved over the edge of its world, or that nothing carries.

    A robot has left the world until it is back above that depth, or begins again. The lowest shape is that at the
    start.
    """

    def __init__(self, simulation: Simulation) -> None:
        self._simulation = simulation
        self._reports: WeakSet[Robot] = WeakSet()
        self._first = self._next = 0
        self._loaded = simulation.loaded
        self._bottom, self._has_floor = lowest_shape(simulation.world)

    def review(self, tick: int, changed: bool) -> int:
        """Check some robots; see `morse.simulation.ticks.ticking.Ticker.reviews`."""
        if self._loaded is not self._simulation.loaded:
            self._loaded = self._simulation.loaded
            self._reports.clear()  # a restart, with the same robots
        if changed:
            self._next = tick
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
        body, world = robot.bge_object, self._simulation.world
        height = body.world_pose()[0][2]
        if height > self._bottom - _BELOW:
            self._reports.discard(robot)
            return
        gravity = -float(world.model.opt.gravity[2])
        falls = -body.velocity()[0][2] > _SHARE * math.sqrt(2.0 * max(gravity, 0.0) * _BELOW)
        if falls and robot not in self._reports and gravity > 0.0 and not world.bodies.is_weightless(body.slot):
            self._reports.add(robot)
            self._report(robot, height)

    def _report(self, robot: Robot, height: float) -> None:
        simulation, name = self._simulation, robot.name()
        world = f"'{simulation.scene.environment}'"
        floor = f"below the floor of {world}" if self._has_floor else f"and {world} has no floor"
        place = f"it is at z = {height:.1f} m, {floor}"
        slot = simulation.world.slots[robot.bge_object.slot]
        if bottom_of(simulation.world, slot.frame.root.node) is None:
            place += "; it has no collision shapes that could stand on one"
        created = next((one.where for one in simulation.scene.components if one.name == name), None)
        line = str(created) if created is not None else ""
        simulation.context.guard.note(Failure("fallen", name, "has left the world", simulation.clock.time, place, line))
        if simulation.scene.settings.fallen == "error" and not simulation.options.keep_going:
            at = f" ({line})" if line else ""
            simulation.part_failed(FallenError(f"{name} has left the world: {place}{at}"), name)
            return
        # the page shows it in words, and marks the robot
        logger.warning("%s falls: %s; F11 or the service simulation.reset begins again", name, place)


# Warns about sensors of users whose data do not match their declarations.

#: types of initial values, by the declared type of a field
_TYPES: dict[str, tuple[type, ...]] = {
    "float": (float, int), "double": (float, int), "int": (int,), "integer": (int,), "bool": (bool,),
    "boolean": (bool,), "string": (str,), "str": (str,),
}  # fmt: skip


class PublishedData:
    """Checks the data after ticks 1, 2, 4, 8, and so on: errors of the first measurement and rare ones are found.

    The sensors of MORSE itself are not checked: `morse check component` and its tests do that.
    """

    def __init__(self, simulation: Simulation) -> None:
        self._simulation = simulation
        # a new version of a class is reported again
        self._reports: set[tuple[str, str, type]] = set()
        self._begin = self._next = 0

    def review(self, tick: int, changed: bool) -> int:
        """Check all sensors of users; see `morse.simulation.ticks.ticking.Ticker.reviews`."""
        if changed:
            self._begin, self._next = tick - 1, tick
        if tick < self._next:
            return self._next
        self._next = tick + max(1, tick - self._begin)
        sensors = self._simulation.loaded.sensors
        users = [one for one in sensors if not type(one).__module__.startswith("morse.") and one.active]
        guard = self._simulation.context.guard
        # what cannot be read makes the sensor fail, and not the check
        guard.each(users, self._check, guard.deactivate)
        return self._next

    def _check(self, sensor: Object) -> None:
        if not sensor.local_data.get("timestamp"):  # a measurement has a time stamp
            return
        for text in uncover(sensor):
            if (sensor.name(), text, type(sensor)) not in self._reports:
                self._reports.add((sensor.name(), text, type(sensor)))
                logger.warning("%s: %s", sensor.name(), text)
        for field, _, text in misfits(sensor, _is_definite):
            key = sensor.name(), field, type(sensor)
            if key in self._reports:
                continue
            self._reports.add(key)
            # a sensor may publish any number of them
            line = f"{sensor.name()} ({type(sensor).__name__}): {text}"
            self._simulation.context.complaints.warn(line, line)


def _is_definite(field: DataField) -> bool:
    """Return whether type and initial value agree: components of 1.4 declare a list with the initial value 'none'."""
    return field.shape is not None or type(field.default) in _TYPES.get(field.type, ())
