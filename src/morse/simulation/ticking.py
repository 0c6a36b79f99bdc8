"""The order of a tick."""

from __future__ import annotations

import logging
import sys
from time import perf_counter
from typing import TYPE_CHECKING, Any

from morse.core.context import acting
from morse.core.overwritten import uncover
from morse.core.realism import Realism
from morse.core.requests import serve
from morse.core.sensor import Sensor
from morse.simulation.faults import describe
from morse.simulation.schedule import Schedule
from morse.simulation.together import Together, arranged, phase_of

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from morse.core.abstractobject import AbstractObject
    from morse.core.context import Context
    from morse.core.object import Object
    from morse.core.observer import Observer
    from morse.core.robot import Robot
    from morse.simulation.loader import Loaded
    from morse.simulation.profile import Profile
    from morse.simulation.stepping import Stepping

logger = logging.getLogger(__name__)


class Ticker:
    """Runs a tick: input, services, actuators, physics, rays, sensors, output.

    Attributes:
        observers: notified before and after each tick, in order.
        profiles: profiles that measure each tick; without profiles ticks are not measured.
        reviews: functions that look at the components from time to time: called after a tick with its number and
            whether the components have changed, they return the tick of their next call.
        drag: callbacks that apply forces to bodies, called before the physics of each tick.
    """

    def __init__(self, context: Context, stepping: Stepping) -> None:
        self._context = context
        self._clock = context.clock
        self._stepping = stepping
        self.observers: list[Observer] = []
        self.profiles: list[Profile] = []
        self.component_profiles: list[Profile] = []
        self.before_physics: list[Callable[[], object]] = []
        self.reviews: list[Callable[[int, bool], int]] = []
        self._acting = acting(context)
        self._groups: list[Together] = []
        self._served: list[AbstractObject] = []
        self._offered = 0

    def schedule(self, loaded: Loaded) -> None:
        """Set the components of the simulation after they have changed."""
        frequency = self._clock.frequency
        self._robots = loaded.robots
        self._robot_attributes = [vars(robot) for robot in loaded.robots]
        self._watched = -1
        self._review_at, self._has_changed = 0, True
        self.separate()
        self._actuators: Schedule[Any] = Schedule(arranged(loaded.actuators, self._act_alone), frequency)
        self._sensors: Schedule[Any] = Schedule(arranged(loaded.sensors, self._act_alone), frequency, _phase)
        self._groups = [
            unit for units in (self._actuators, self._sensors) for unit in units if isinstance(unit, Together)
        ]
        sensors = [sensor for sensor in loaded.sensors if isinstance(sensor, Sensor)]
        self._asking_actuators = Schedule([a for a in loaded.actuators if a.requests], frequency)
        self._asking_sensors = Schedule([s for s in loaded.sensors if s.requests], frequency, _phase)
        self._delayed = [s.realism for s in sensors if isinstance(s.realism, Realism) and s.realism.delay]

    def separate(self) -> None:
        """Dissolve all groups of components that act together, until the next tick."""
        for group in self._groups:
            group.dissolve()

    def tick(self) -> bool:
        """Run one tick.

        Returns:
            False if input has paused the simulation, so that no time has passed.
        """
        with self._acting:
            if self.profiles:
                return self._measured_tick()
            self._take_input()
            self._serve()
            # the simulation is paused, or was restarted while paused: the state must not change until the next request
            if self._stepping.halted:
                return False
            self._actuate()
            self._move()
            self._answer_sensors()
            self._sense()
            self._show()
        return True

    def _measured_tick(self) -> bool:
        """Run one tick, and measure the time of each phase."""
        profiles = self.profiles
        for profile in profiles:
            profile.begin()
        for name, phase in (("input", self._take_input), ("services", self._serve)):
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

    def look(self) -> None:
        """Process input and services while the simulation is paused."""
        with self._acting:
            for observer in self.observers:
                observer.before_tick()
            self._context.services.process()
            for observer in self.observers:
                observer.after_tick()

    # -- the phases ------------------------------------------------------------------------

    def _take_input(self) -> None:
        for observer in self.observers:
            observer.before_tick()
        self._clock.observe()

    def _serve(self) -> None:
        objects = self._context.service_objects
        if len(objects) != self._offered:
            self._offered = len(objects)
            self._served = [obj for obj in objects if not obj.is_idle]
        for obj in self._served:
            obj.action()
        self._context.services.process()

    def _actuate(self) -> None:
        self._due = self._clock.tick
        self._act(self._busy_robots())
        if asking := self._asking_actuators.due(self._due):
            serve(asking)
        self._act(self._actuators.due(self._due))

    def _move(self) -> None:
        for push in self.before_physics:
            push()
        self._context.world.step()
        self._clock.advance()
        for robot in self._busy:
            robot.update_pose()

    def _answer_sensors(self) -> None:
        """Answer the requests of all due sensors in one call, which costs little more than a call for one sensor."""
        if asking := self._asking_sensors.due(self._due):
            serve(asking)

    def _sense(self) -> None:
        self._act(self._sensors.due(self._due))
        for realism in self._delayed:
            try:
                realism.release()
            except Exception as error:
                self._switch_off(realism.sensor, error)

    def _show(self) -> None:
        for observer in self.observers:
            observer.after_tick()
        if self._clock.tick >= self._review_at:
            self._review(self._clock.tick)

    def _review(self, tick: int) -> None:
        changed, self._has_changed = self._has_changed, False
        self._review_at = min((review(tick, changed) for review in self.reviews), default=sys.maxsize)

    # -- components ------------------------------------------------------------------------

    def _busy_robots(self) -> Sequence[Robot]:
        """Return the robots that have work to do; an action may be added to a robot as an attribute."""
        size = sum(map(len, self._robot_attributes))
        if size != self._watched:
            self._watched = size
            self._busy = [robot for robot in self._robots if not robot.is_idle]
        return self._busy

    def _act(self, components: Sequence[Any]) -> None:
        if self.component_profiles:
            for component in components:
                if type(component) is Together:
                    self._measured(component)
                else:
                    self._act_alone(component)
            return
        for component in components:
            try:
                component.action()
            except Exception as error:
                if type(component) is Together:
                    raise
                self._switch_off(component, error)

    def _act_alone(self, component: Object) -> None:
        try:
            if self.component_profiles:
                self._measured(component)
            else:
                component.action()
        except Exception as error:
            self._switch_off(component, error)

    def _switch_off(self, component: Object, error: Exception) -> None:
        component.active = False
        for text in uncover(component):
            logger.error("[ERROR][MORSE] %s: %s", component.name(), text)
        self._context.failed.add(component.name())
        logger.error("[ERROR][MORSE] %s failed and is deactivated: %s", component.name(), describe(error))

    def _measured(self, component: Any) -> None:
        begin = perf_counter()
        component.action()
        end = perf_counter()
        for profile in self.component_profiles:
            profile.component(component.name(), begin, end)


def _phase(component: Any) -> float:
    return component.phase if type(component) is Together else phase_of(component)
