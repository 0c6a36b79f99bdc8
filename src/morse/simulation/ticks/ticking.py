"""The order of a tick, and which components act in it."""

from __future__ import annotations

import math
import sys
from fractions import Fraction
from operator import call
from time import perf_counter
from typing import TYPE_CHECKING, Generic, Protocol, TypeVar, cast

from morse.core.abstractobject import AbstractObject
from morse.core.actuator import Actuator
from morse.core.context import acting
from morse.core.guard import after_tick, before_tick
from morse.core.realism import Realism, phase_of
from morse.core.reports.faults import name_of
from morse.core.requests import serve
from morse.core.rows.rows import ActuatorRows, Rows, SensorRows
from morse.core.sensor import OnDemand, Sensor, hold_on_demand
from morse.simulation.ticks.multi_tick import MultiTick

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterable, Iterator, Sequence, Sized

    from morse.core.context import Context
    from morse.core.interfaces import Acting
    from morse.core.object import Object
    from morse.core.observer import Observer
    from morse.core.robot import Robot
    from morse.core.rows.columns import Setpoints
    from morse.simulation.loader import Loaded
    from morse.simulation.ticks.profile import Profile
    from morse.simulation.ticks.stepping import Stepping


class _Periodic(Protocol):
    frequency: float


_C = TypeVar("_C", bound=_Periodic)

#: maximum length of cached patterns, ticks
_LONGEST_PATTERN = 3600


class Schedule(Generic[_C]):
    """Schedules components by frequency; components keep their order within a tick.

    A component of rate ``f`` and phase ``p`` (s) in a simulation of rate ``b`` acts in tick ``k`` (from 0, not before
    ``b p``) if ``floor((k - b p) f/b)`` differs from ``floor((k - 1 - b p) f/b)``: as evenly as ticks allow, and
    exactly ``f`` times per second on average. The ticks are computed from integers, so that the schedule never drifts.

    Args:
        frequency: frequency of the simulation, Hz.
        phase: function that returns the phase of a component, s; None if all phases are 0.
    """

    def __init__(self, components: Iterable[_C], frequency: float, phase: Callable[[_C], float] | None = None) -> None:
        base = _fraction(frequency)
        self._entries: list[tuple[_C, int, int, int]] = []
        self._first, pattern = 0, 1
        for component in components:
            rate, late = (
                _fraction(component.frequency) / base,
                _fraction(phase(component) if phase is not None else 0.0) * base,
            )
            # over a common denominator: floor((k n - s) / d)
            shift = late * rate
            common = math.lcm(rate.denominator, shift.denominator)
            n, s = rate * common, shift * common
            self._entries.append((component, int(n), int(s), common))
            self._first = max(self._first, math.ceil(late))
            pattern = math.lcm(pattern, rate.denominator)
        self._pattern = pattern if pattern <= _LONGEST_PATTERN else 0
        self._known: dict[int, list[_C]] = {}

    def __iter__(self) -> Iterator[_C]:
        return (entry[0] for entry in self._entries)

    def place(self, tick: int) -> int | None:
        """Return a number that is equal for ticks in which, and after which, the same components act; or None."""
        return tick % self._pattern if self._pattern and tick >= self._first else None

    def due(self, tick: int) -> list[_C]:
        """Return the components that act in a tick, counted from 0. The list must not be modified."""
        if not self._pattern or tick < self._first:
            return self._due(tick)
        place = tick % self._pattern
        entries = self._known.get(place)
        if entries is None:
            entries = self._known[place] = self._due(tick)
        return entries

    def _due(self, tick: int) -> list[_C]:
        return [c for c, n, s, d in self._entries if tick * n >= s and (tick * n - s) // d != ((tick - 1) * n - s) // d]


def _fraction(value: float) -> Fraction:
    return Fraction(value).limit_denominator(10**6)


def arranged(components: Sequence[Object], act: Callable[[Sequence[Acting]], None]) -> list[Acting]:
    """Return components in the order of their actions, with those of a class whose members may be rows in one entry.

    Actuators of a robot with several actuators keep their position in the order, because the last one takes precedence.
    """
    carriers: dict[int, int] = {}
    for component in components:
        carriers[id(component.robot_parent)] = carriers.get(id(component.robot_parent), 0) + 1
    order: list[Object | list[Object]] = []
    alike: dict[tuple[object, float, float, str | None], list[Object]] = {}
    for component in components:
        is_on_demand = isinstance(component, Sensor) and component.on_demand
        if (
            is_on_demand
            or not component.acts_in_rows
            or (isinstance(component, Actuator) and carriers[id(component.robot_parent)] > 1)
        ):
            order.append(component)
            continue
        key = (type(component), component.frequency, phase_of(component), component.level)
        if key not in alike:
            alike[key] = []
            order.append(alike[key])
        alike[key].append(component)
    return [_rows(entry, act) if isinstance(entry, list) else entry for entry in order]


def _rows(members: Sequence[Object], act: Callable[[Sequence[Acting]], None]) -> ActuatorRows | SensorRows:
    if isinstance(members[0], Actuator):
        return ActuatorRows(cast("Sequence[Actuator]", members), act)
    return SensorRows(cast("Sequence[Sensor]", members), act)


def _release(realism: Realism) -> None:
    realism.release()


class Ticker:
    """Runs a tick: input, services, actuators, physics, rays, sensors, output.

    Attributes:
        observers: notified before and after each tick, in order.
        profiles: profiles that measure each tick; without profiles ticks are not measured.
        reviews: functions that look at the components from time to time: called after a tick with its number and
            whether the components have changed, they return the tick of their next call.
        before_physics: callbacks that apply forces to bodies, called before the physics of each tick.
    """

    def __init__(self, context: Context, stepping: Stepping) -> None:
        self._context, self._guard = context, context.guard
        self._clock, self._services = context.clock, context.services
        self._stepping = stepping
        self.observers: list[Observer] = []
        self.profiles: list[Profile] = []
        self.component_profiles: list[Profile] = []
        self.before_physics: list[Callable[[], object]] = []
        self.reviews: list[Callable[[int, bool], int]] = []
        self._acting = acting(context)
        self._rows: list[ActuatorRows | SensorRows] = []
        #: what holds the data of sensors that measure while somebody reads them
        self._held: list[OnDemand] = []
        #: objects that offer services and act, and what they wait for
        self._served: list[tuple[AbstractObject, Sized | None]] = []
        self._offered = 0

    def schedule(self, loaded: Loaded) -> None:
        """Set the components of the simulation after they have changed."""
        frequency = self._clock.frequency
        self._robots = loaded.robots
        self._robot_attributes = [vars(robot) for robot in loaded.robots]
        self._watched, self._review_at, self._has_changed = -1, 0, True
        self.separate()
        # in reverse order, as in 1.4: of several actuators of a robot, the one created first has the last word; but
        # keys and sticks that are held always have it
        actuators = loaded.actuators[::-1]
        actuators.sort(key=lambda actuator: bool(getattr(actuator, "obeys_controls", False)))
        self._actuators: Schedule[Acting] = Schedule(arranged(actuators, self._act), frequency)
        self._sensors: Schedule[Acting] = Schedule(arranged(loaded.sensors, self._act), frequency, _phase)
        entries = [*self._actuators, *self._sensors]
        self._rows = [entry for entry in entries if isinstance(entry, (ActuatorRows, SensorRows))]
        sensors = [sensor for sensor in loaded.sensors if isinstance(sensor, Sensor)]
        self._held = [held for one in sensors if one.on_demand and (held := hold_on_demand(one)) is not None]
        asking = [a for a in loaded.actuators if a.requests]
        self._asking_actuators = Schedule(asking, frequency) if asking else None
        asking_sensors = [s for s in loaded.sensors if s.requests]
        self._asking_sensors = Schedule(asking_sensors, frequency, _phase) if asking_sensors else None
        #: by the place in the schedule: sensors that are not due in a tick, and those of them with requests
        self._others: dict[int, tuple[list[Acting], list[Object]]] = {}
        self._leaping = MultiTick(self._context, self._actuators, self._sensors)
        self._delayed = [s.realism for s in sensors if isinstance(s.realism, Realism) and s.realism.delay]

    def separate(self) -> None:
        """Let no component be a row: all have the data and the poses of their last actions."""
        for rows in self._rows:
            rows.release()
        for held in self._held:
            held.release()

    def begin_anew(self) -> None:
        """Begin again with the same components, whose states are those after they were created."""
        self._watched, self._review_at, self._has_changed = -1, 0, True
        self.gather()

    def gather(self) -> None:
        """Undo `separate`."""
        for rows in self._rows:
            rows.form()
        for held in self._held:
            held.form()

    def tick(self) -> bool:
        """Run one tick.

        Returns:
            False if input has paused the simulation, so that no time has passed.
        """
        with self._acting:
            if self.profiles:
                return self._measured_tick()
            self._take_input()
            self._process_services()
            # the simulation is paused, or was restarted while paused: the state must not change until the next request
            if self._stepping.paused and self._stepping.halted:
                return False
            self._actuate()
            self._move()
            if self._asking_sensors is not None:
                self._answer_sensors()
            self._sense()
            self._show()
        return True

    def advance(self, most: int, measured: bool) -> int:
        """Run some ticks within a step; return their number, at least 1.

        Args:
            most: largest number.
            measured: whether all sensors measure after that many ticks.
        """
        if most == 1 or not self._may_leap():
            self.tick()
            return 1
        with self._acting:
            self._take_input()
            self._process_services()
            self._actuate()
            leap = None
            if not (self._busy or self._alarmed()) and self._leaping.look():
                leap = self._leaping.plan(self._due, most, measured)
            if leap is None or leap.ticks == 1:
                self._move()
                self._answer_sensors()
                self._sense()
            else:
                self._leaping.run(leap.ticks, self.observers)
                for rows, number in leap.skips:
                    rows.skip(number)
                self._due += leap.ticks - 1
                if leap.asking:
                    serve(leap.asking, self._guard)
                self._act(leap.sensors)
            self._show()
        return 1 if leap is None else leap.ticks

    @property
    def coasts(self) -> bool:
        """Whether nothing can happen in any of the next ticks but that robots drive."""
        return self._is_calm() and self._leaping.coasts

    def _is_calm(self) -> bool:
        """Whether nothing but actuators and sensors can have work in any of the next ticks."""
        return (
            self._may_leap()
            and not self._busy_robots()
            and not self._alarmed()
            and all(observer.waits for observer in self.observers)
        )

    def moved_joints(self) -> Sequence[tuple[Actuator, Setpoints]] | None:
        """The actuators, if nothing can happen in the next ticks but that they move joints toward setpoints, else None.

        Sensors then need not measure before the end of a step at whose end all of them do.
        """
        return self._leaping.moved_joints() if self._is_calm() else None

    def missed(self) -> None:
        """Let sensors measure that need their previous measurement, after steps that were run elsewhere."""
        with self._acting:
            self._act(self._leaping.remembering)

    def obey(self) -> bool:
        """Take the commands of the next tick while nothing else can happen; return whether robots go on."""
        with self._acting:
            return self._leaping.obey()

    def coasted(self, ticks: int, *, measured: bool) -> None:
        """Take note of ticks in which nothing else could happen, after the world has.

        Args:
            measured: whether all sensors measure.
        """
        self._leaping.went_on(ticks)
        if not measured:
            return
        with self._acting:
            self._due = self._clock.tick - 1
            self._answer_sensors()
            self._sense()
            self._show()
        self.measure(None, again=False)

    def _may_leap(self) -> bool:
        """Whether nothing but a component can have work in a tick."""
        return (
            self._leaping.is_possible
            and not (self.profiles or self.component_profiles or self._delayed or self.before_physics)
            and self._context.network is None
            and self._context.services.is_quiet
            and self._stepping.is_idle
            and all(observer.sees_steps for observer in self.observers)
        )

    def _measured_tick(self) -> bool:
        """Run one tick, and measure the time of each phase."""
        profiles = self.profiles
        for profile in profiles:
            profile.begin()
        for name, phase in (("input", self._take_input), ("services", self._process_services)):
            phase()
            for profile in profiles:
                profile.mark(name)
        if self._stepping.halted:
            return False
        for name, phase in (
            ("actuators", self._actuate),
            ("physics", self._move),
            ("rays", self._answer_sensors),
            ("sensors", self._sense),
            ("output", self._show),
        ):
            phase()
            for profile in profiles:
                profile.mark(name)
        return True

    def measure(self, names: Collection[str] | None, *, again: bool) -> None:
        """Let sensors measure between two ticks.

        Args:
            names: full names; None for all.
            again: whether those measure, too, that have measured in the last tick.
        """
        place = None if again or names is not None else self._sensors.place(self._due)
        if place is not None:
            if place not in self._others:
                due = self._sensors.due(self._due)
                units = [unit for unit in self._sensors if not any(unit is one for one in due)]
                self._others[place] = units, [sensor for sensor in _members(units) if sensor.requests]
            units, asking = self._others[place]
            if not units:
                return
            with self._acting:
                if asking:
                    serve(asking, self._guard)
                self._act(units)
            return
        measured = () if again else map(id, self._sensors.due(self._due))
        before = set(measured)
        chosen: list[Acting] = []
        released: list[Rows[Sensor]] = []
        for unit in self._sensors:
            if id(unit) in before:
                continue
            members: Sequence[Acting] = unit.members if isinstance(unit, SensorRows) else (unit,)
            wanted = members if names is None else [member for member in members if member.name() in names]
            if len(wanted) == len(members):
                chosen.append(unit)
            elif wanted and isinstance(unit, SensorRows):
                unit.release()
                released.append(unit)
                chosen += wanted
        with self._acting:
            sensors = _members(chosen)
            if again:
                self._guard.each(sensors, _look_again, self._guard.deactivate)
            if asking := [sensor for sensor in sensors if sensor.requests]:
                serve(asking, self._guard)
            self._act(chosen)
        for unit in released:
            unit.form()

    def look(self) -> None:
        """Process input and services while the simulation is paused."""
        with self._acting:
            self._guard.each(self.observers, before_tick, self._dismiss)
            self._context.services.process()
            self._guard.each(self.observers, after_tick, self._dismiss)

    # -- the phases ------------------------------------------------------------------------

    def _dismiss(self, observer: Observer, error: BaseException) -> None:
        self._guard.dismiss(self.observers, observer, error)

    def _take_input(self) -> None:
        if self.observers:
            self._guard.each(self.observers, before_tick, self._dismiss)
        self._clock.observe()

    def _process_services(self) -> None:
        objects = self._context.service_objects
        if len(objects) != self._offered:
            self._offered = len(objects)
            active = self._guard.those(objects, _is_busy, self._stop_serving)
            self._served = [(one, _work_of(one)) for one in active]
        if self._services.has_work():
            self._services.process()

    def _stop_serving(self, part: AbstractObject, error: BaseException) -> None:
        who = f"{type(part).__name__} of the services of '{name_of(part)}'"
        self._guard.failed(part, who, "does not act any more", error)
        self._served = [(one, sign) for one, sign in self._served if one is not part]

    def _alarmed(self) -> list[AbstractObject]:
        """Return the objects that offer services and have work in this tick."""
        return [one for one, sign in self._served if sign is None or sign]

    def _actuate(self) -> None:
        self._due = self._clock.tick
        if robots := self._busy_robots():
            self._act(robots)
        if self._asking_actuators is not None and (asking := self._asking_actuators.due(self._due)):
            serve(asking, self._guard)
        self._act(self._actuators.due(self._due))

    def _move(self) -> None:
        if self.before_physics:
            self._guard.each(list(self.before_physics), call, self._remove_push)
        self._context.world.step()
        self._clock.advance()
        if self._busy:
            self._guard.each(self._busy, _update_pose, self._guard.deactivate)
        if not self._context.world.physics_of_1_4:
            # before the sensors: who has slept until this time is awake when its messages arrive
            self._end_services()

    def _end_services(self) -> None:
        """End the services that are due at this time, such as sleeps, and answer them."""
        if self._served and (alarmed := self._alarmed()):
            self._guard.each(alarmed, _act, self._stop_serving)
        if self._services.has_work():
            self._services.answer()

    def _remove_push(self, push: Callable[[], object], error: BaseException) -> None:
        self._guard.remove(self.before_physics, push, error)

    def _answer_sensors(self) -> None:
        """Answer the requests of all due sensors in one call, which costs little more than a call for one sensor."""
        if self._asking_sensors is not None and (asking := self._asking_sensors.due(self._due)):
            serve(asking, self._guard)

    def _sense(self) -> None:
        self._act(self._sensors.due(self._due))
        if self._delayed:
            self._guard.each(self._delayed, _release, self._stop_releasing)

    def _stop_releasing(self, realism: Realism, error: BaseException) -> None:
        self._guard.deactivate(realism.sensor, error)
        self._delayed = [one for one in self._delayed if one is not realism]

    def _show(self) -> None:
        if self.observers:
            self._guard.each(self.observers, after_tick, self._dismiss)
        if self._context.world.physics_of_1_4:
            # there, who had slept was awake when the messages of this time had been sent, and waited for the next ones
            self._end_services()
        if self._clock.tick >= self._review_at:
            self._review(self._clock.tick)

    def _review(self, tick: int) -> None:
        has_changed, self._has_changed = self._has_changed, False
        due: list[int] = []
        self._guard.each(
            self.reviews,
            lambda review: due.append(int(review(tick, has_changed))),
            lambda review, error: self._guard.remove(self.reviews, review, error),
        )
        self._review_at = min(due, default=sys.maxsize)

    # -- components ------------------------------------------------------------------------

    def _busy_robots(self) -> Sequence[Robot]:
        """Return the robots that have work to do; an action may be added to a robot as an attribute."""
        size = sum(map(len, self._robot_attributes))
        if size != self._watched:
            self._watched = size
            self._busy = self._guard.those(self._robots, _is_busy, self._guard.deactivate)
        return self._busy

    def _act(self, components: Sequence[Acting]) -> None:
        if self.component_profiles:
            self._guard.each(components, self._measured, self._guard.deactivate)
        else:
            self._guard.act(components)

    def _measured(self, component: Acting) -> None:
        begin = perf_counter()
        component.action()
        end = perf_counter()
        for profile in self.component_profiles:
            profile.component(component.name(), begin, end)


def _look_again(sensor: Object) -> None:
    if isinstance(sensor, Sensor):
        sensor.look_again()


def _members(units: Sequence[Acting]) -> list[Object]:
    return [one for unit in units for one in (unit.members if isinstance(unit, Rows) else (unit,))]


def _act(part: AbstractObject) -> None:
    part.action()


def _update_pose(robot: Robot) -> None:
    robot.update_pose()


def _phase(component: Acting) -> float:
    return component.phase if isinstance(component, Rows) else phase_of(component)


def _work_of(part: AbstractObject) -> Sized | None:
    """`AbstractObject.waiting`; None for objects of users of any other class."""
    return part.waiting if isinstance(part, AbstractObject) else None


def _is_busy(part: AbstractObject) -> bool:
    return not part.is_idle
