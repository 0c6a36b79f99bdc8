"""Several ticks at once, while nothing can happen but that robots move.

Within `Simulation.step`, nobody outside sees the ticks before the last one. If nothing has arrived, the actuators go on
as in the tick before. What a sensor measures in a tick need not be measured if it measures again later. What remains is
the physics. The data, the states and the hashes are those of single ticks.
"""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING, Any

from morse.core.guard import after_tick
from morse.core.reports.faults import is_a
from morse.core.rows.actuator_rows import ActuatorRows
from morse.core.rows.sensor_rows import SensorRows

if TYPE_CHECKING:
    from collections.abc import Sequence

    from morse.core.context import Context
    from morse.core.observer import Observer
    from morse.simulation.ticks.schedule import Schedule

#: largest number of ticks of a leap, so that Ctrl+C ends a step soon
_MOST = 64


class Leaping:
    """Finds out how many ticks can be run at once, and runs all but their beginning and their end.

    Args:
        actuators, sensors: the components and rows of the simulation.
    """

    def __init__(self, context: Context, actuators: Schedule[Any], sensors: Schedule[Any]) -> None:
        self._context = context
        frequency = context.clock.frequency
        self._sensors = sensors
        self._drives: list[ActuatorRows] = []
        self._scans: list[SensorRows] = []
        #: whether all components are rows, those that drive in each tick
        self.is_possible = True
        for entry in actuators:
            drives = is_a(entry, ActuatorRows) and entry.frequency >= frequency
            self.is_possible &= drives and not any(member.requests for member in entry.members)
            self._drives.append(entry)
        #: whether all sensors are rows that forget their previous measurements
        self._forgets = True
        for entry in sensors:
            if is_a(entry, SensorRows):
                self._scans.append(entry)
                self._forgets &= not entry.remembers
            else:
                self._forgets = False
        self._known: dict[tuple[int, int, bool], tuple[int, list[tuple[SensorRows, int]]]] = {}

    @property
    def coasts(self) -> bool:
        """Whether the same holds for any number of ticks, after which all sensors measure."""
        return self._forgets and len(self._drives) == 1 and self.look()

    def obey(self) -> bool:
        """Take the commands that have arrived for the next tick; return whether the robots go on at these speeds."""
        for drive in self._drives:
            drive.prepare()
        return self.look()

    def went_on(self, ticks: int) -> None:
        """Take note of ticks that were run without a call for each of them."""
        for drive in self._drives:
            drive.went_on(ticks)
        self._context.clock.advance(ticks)

    def look(self) -> bool:
        """Whether no actuator has anything to do but to go on, and rows of sensors need not measure in each tick."""
        for drive in self._drives:
            if not drive.lasts:
                return False
        return all(scan.may_skip() for scan in self._scans)

    def ticks(self, first: int, most: int, measured: bool) -> tuple[int, list[tuple[SensorRows, int]]]:
        """Return the number of ticks up to the first one in which a sensor has to measure.

        Args:
            first: number of the next tick.
            most: number of ticks that are wanted.
            measured: whether all sensors measure after the last one.

        Returns:
            The number, 1 or more; and the rows with the number of their measurements that are left out.
        """
        if most > _MOST:
            most, measured = _MOST, False
        place = self._sensors.place(first)
        if place is None:
            return self._count(first, most, measured)
        key = place, most, measured
        if key not in self._known:
            self._known[key] = self._count(first, most, measured)
        return self._known[key]

    def _count(self, first: int, most: int, measured: bool) -> tuple[int, list[tuple[SensorRows, int]]]:
        due = [self._sensors.due(first + number) for number in range(most)]
        later: dict[int, int] = {id(scan): int(measured) for scan in self._scans}
        for entry in due[-1]:
            later[id(entry)] = 1
        full = [False] * most
        full[-1] = True
        # backwards: how often is each measured after this tick?
        for number in range(most - 2, -1, -1):
            for entry in due[number]:
                needed = not is_a(entry, SensorRows) or later[id(entry)] < 1 + entry.remembers
                full[number] |= needed
            for entry in due[number]:
                later[id(entry)] = later.get(id(entry), 0) + 1
        count = full.index(True) + 1
        # by identity: a component may refuse to be compared
        measuring = Counter(id(entry) for entries in due[: count - 1] for entry in entries)
        skips = [(scan, measuring[id(scan)]) for scan in self._scans]
        return count, [(scan, number) for scan, number in skips if number]

    def run(self, ticks: int, observers: Sequence[Observer]) -> None:
        """Run the physics of ticks.

        The actuators have acted in the first one. The observers are notified of all but the last one.
        """
        context, drives = self._context, self._drives
        world, clock, guard = context.world, context.clock, context.guard
        while True:
            done = world.step_freely(ticks) if all(observer.waits for observer in observers) else 0
            if done > 1:
                for drive in drives:
                    drive.went_on(done - 1)
            if not done:
                world.step()
                done = 1
            clock.advance(done)
            ticks -= done
            if not ticks:
                return
            guard.tell(observers, after_tick)  # type: ignore[arg-type]
            for drive in drives:
                drive.go_on()
