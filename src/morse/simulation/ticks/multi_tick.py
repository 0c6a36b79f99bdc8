"""Several ticks at once, while nothing can happen but that robots move.

Within `Simulation.step`, nobody outside sees the ticks before the last one. If nothing has arrived, the actuators go on
as in the tick before. What a sensor measures in a tick need not be measured if it measures again later. What remains is
the physics. A camera whose images nobody reads has nothing to do. The data, the states and the hashes are those of
single ticks.
"""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING, NamedTuple

from morse.core.actuator import Actuator
from morse.core.guard import after_tick
from morse.core.reports.faults import is_a
from morse.core.rows.rows import ActuatorRows, Rows, SensorRows
from morse.core.sensor import Sensor

if TYPE_CHECKING:
    from collections.abc import Sequence

    from morse.core.context import Context
    from morse.core.interfaces import Acting, Component
    from morse.core.observer import Observer
    from morse.core.rows.columns import Setpoints
    from morse.simulation.ticks.ticking import Schedule

#: largest number of ticks of a leap, so that Ctrl+C ends a step soon
_MOST = 256


class TickSpan(NamedTuple):
    """Ticks that are run at once.

    Attributes:
        ticks: their number, 1 or more.
        sensors: those that measure in the last one.
        asking: their members with requests.
        skips: rows with the number of their measurements that are left out.
    """

    ticks: int
    sensors: Sequence[Acting]
    asking: Sequence[Component]
    skips: Sequence[tuple[SensorRows, int]]


class MultiTick:
    """Finds out how many ticks can be run at once, and runs all but their beginning and their end.

    Args:
        actuators, sensors: the components and rows of the simulation.
    """

    def __init__(self, context: Context, actuators: Schedule[Acting], sensors: Schedule[Acting]) -> None:
        self._context = context
        frequency = context.clock.frequency
        self._sensors = sensors
        self._drives: list[ActuatorRows] = []
        self._scans: list[SensorRows] = []
        #: actuators that act in each tick, and may have nothing to do
        self._holding: list[Actuator] = []
        #: whether the actuators may go on without a call, in each tick
        self.is_possible = True
        for entry in actuators:
            drives = is_a(entry, ActuatorRows)
            self.is_possible &= (drives or is_a(entry, Actuator)) and entry.frequency >= frequency
            self.is_possible &= not self._asking([entry])
            (self._drives if drives else self._holding).append(entry)  # type: ignore[arg-type] # one of the two
        #: the other sensors, and whether none of them has anything to do before somebody outside of the ticks reads it
        self._others: list[Acting] = []
        self._rests = True
        #: whether all sensors are rows that forget their previous measurements
        self._forgets = True
        for entry in sensors:
            if is_a(entry, SensorRows):
                self._scans.append(entry)
                self._forgets &= not entry.remembers
            else:
                self._others.append(entry)
                self._forgets = False
        self._plans: dict[tuple[int, int, bool, bool], TickSpan] = {}

    @property
    def coasts(self) -> bool:
        """Whether the same holds for any number of ticks, after which all sensors measure."""
        return self._forgets and len(self._drives) == 1 and not self._holding and self.look()

    def moved_joints(self) -> Sequence[tuple[Actuator, Setpoints]] | None:
        """The actuators, if all of them do nothing but move joints, and sensors wait, in any number of ticks."""
        if not self.is_possible or self._drives:
            return None
        for scan in self._scans:
            if not scan.may_skip():
                return None
        for other in self._others:
            if not (is_a(other, Sensor) and other.on_demand):
                return None
        moved = []
        for actuator in self._holding:
            setpoints = actuator.lasting_setpoints()
            if setpoints is None:
                return None
            moved.append((actuator, setpoints))
        return moved if self._all_rest(self._others) else None

    @property
    def remembering(self) -> Sequence[SensorRows]:
        """The rows of sensors that need their previous measurement."""
        return [scan for scan in self._scans if scan.remembers]

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
        for scan in self._scans:
            if not scan.may_skip():
                return False
        self._rests = self._all_rest(self._others)
        return self._all_rest(self._holding)

    def _all_rest(self, components: Sequence[object]) -> bool:
        # who cannot tell does not rest
        return not components or len(self._context.guard.those(components, _rests, _nothing)) == len(components)

    def plan(self, first: int, most: int, measured: bool) -> TickSpan:
        """Return the leap to the first tick in which a sensor has to measure.

        Args:
            first: number of the next tick.
            most: number of ticks that are wanted.
            measured: whether all sensors measure after the last one.
        """
        if most > _MOST:
            most, measured = _MOST, False
        if self._holding and most > 1:
            # they act in the last tick, because they keep the poses of that time
            most, measured = most - 1, False
        place = self._sensors.place(first)
        if place is None:
            return self._plan(first, most, measured)
        key = place, most, measured, self._rests
        if key not in self._plans:
            self._plans[key] = self._plan(first, most, measured)
        return self._plans[key]

    def _plan(self, first: int, most: int, measured: bool) -> TickSpan:
        due = [self._sensors.due(first + number) for number in range(most)]
        later: dict[int, int] = {id(entry): int(measured) for entry in self._sensors}
        #: the sensors that have to measure in each tick
        acting: list[list[Acting]] = [[] for _ in due]
        acting[-1] = due[-1]
        later.update({id(entry): 1 for entry in due[-1]})
        # backwards: how often is each measured after this tick?
        for number in range(most - 2, -1, -1):
            needed = [entry for entry in due[number] if later[id(entry)] < 1 + _remembers(entry)]
            if not self._rests and not all(is_a(entry, SensorRows) for entry in due[number]):
                needed = due[number]  # the others may read the data of any sensor
            acting[number] = needed
            for entry in due[number]:
                later[id(entry)] += 1
        count = next(number for number, needed in enumerate(acting, 1) if needed or number == most)
        measuring = acting[count - 1]
        # by identity: a component may refuse to be compared
        skips = Counter(id(entry) for entries in due[:count] for entry in entries)
        skips.subtract(map(id, measuring))
        skipped = [(scan, skips[id(scan)]) for scan in self._scans if skips[id(scan)]]
        return TickSpan(count, measuring, self._asking(measuring), skipped)

    def _asking(self, entries: Sequence[Acting]) -> list[Component]:
        """The components with requests."""
        members = [member for entry in entries for member in (entry.members if is_a(entry, Rows) else (entry,))]
        return self._context.guard.those(members, _requests, _nothing)

    def run(self, ticks: int, observers: Sequence[Observer]) -> None:
        """Run the physics of ticks.

        The actuators have acted in the first one. The observers are notified of all but the last one.
        """
        context, drives = self._context, self._drives
        world, clock, guard = context.world, context.clock, context.guard
        while True:
            done = world.advance(ticks if all(observer.waits for observer in observers) else 1)
            if done > 1:
                for drive in drives:
                    drive.went_on(done - 1)
            clock.advance(done)
            ticks -= done
            if not ticks:
                return
            guard.tell(observers, after_tick)  # type: ignore[arg-type]
            for drive in drives:
                drive.go_on()


def _remembers(entry: object) -> bool:
    return is_a(entry, SensorRows) and bool(entry.remembers)


def _rests(component: object) -> bool:
    return is_a(component, (Sensor, Actuator)) and component.rests()  # type: ignore[attr-defined]


def _requests(component: Component) -> object:
    return component.requests


def _nothing(_component: object, _error: BaseException) -> None:
    """What fails is shown by its action."""
