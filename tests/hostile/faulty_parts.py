"""Parts of a simulation that fail in one tick, each in another place."""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import Any

from morse.core.actuator import Actuator
from morse.core.datastream import AbstractDatastream, DatastreamManager
from morse.core.modifier import AbstractModifier
from morse.core.observer import Observer
from morse.core.sensor import Sensor
from morse.helpers.components import add_data, on_read
from morse.robots.fakerobot import FakeRobot

#: raises the error under test; and the tick in which it is called
fault: Callable[[], object] = list
TICK = 3


def fail_in(component: Any) -> None:
    """Raise the error if this is the component and the tick for it."""
    if component.robot_parent.name() == "r0" and component.clock.tick >= TICK:
        fault()


class Gauge(Sensor):
    """A sensor of a user."""

    add_data("count", 0, "int", "Number of measurements")
    where = ""

    def default_action(self) -> None:
        self.local_data["count"] += 1
        if self.where == "sensor" and type(self) is Gauge:
            fail_in(self)
        if (
            self.where == "no data"
            and type(self) is Gauge
            and self.clock.tick >= TICK
            and self.robot_parent.name() == "r0"
        ):
            self.local_data = None  # type: ignore[assignment]

    def report(self) -> None:
        if self.where == "report" and type(self) is Gauge:
            fail_in(self)


class Stubborn(Gauge):
    """It acts whether it is active or not."""

    def action(self) -> None:
        if self.where == "action":
            fail_in(self)
        super().action()

    @property
    def active(self) -> bool:  # type: ignore[override]
        return True

    @active.setter
    def active(self, value: bool) -> None:
        fault()


class Asking(Gauge):
    """Its requests cannot be told, or not be answered."""

    def __init__(self, obj: Any, parent: Any = None) -> None:
        super().__init__(obj, parent)
        if self.where in ("server", "request"):
            self.add_request(Request(self))


class Request:
    def __init__(self, component: Any) -> None:
        self.component = component

    @property
    def server(self) -> type[Request]:
        if self.component.where == "request":
            fail_in(self.component)
        return Request

    @staticmethod
    def serve(requests: list[Request]) -> None:
        for request in requests:
            if request.component.where == "server":
                fail_in(request.component)


class Motor(Actuator):
    """An actuator of a user."""

    where = ""

    def default_action(self) -> None:
        if self.where == "actuator":
            fail_in(self)


class Carriage(FakeRobot):
    """A robot of a user."""

    where = ""

    def default_action(self) -> None:
        if self.where == "robot" and self.name() == "r0" and self.clock.tick >= TICK:
            fault()

    def update_pose(self) -> None:
        super().update_pose()
        if self.where == "pose of robot" and self.name() == "r0" and self.clock.tick >= TICK:
            fault()


class Team(Sensor):
    """Sensors whose data are computed when they are read."""

    add_data("count", 0, "int", "Number of the measurement")

    def observe(self) -> int:
        if Gauge.where == "observing":
            fail_in(self)
        return 1

    @on_read
    def default_action(self) -> None:
        if Gauge.where == "lazy":
            fail_in(self)
        self.local_data["count"] = self.observation()

    def may_wait(self) -> bool:
        if Gauge.where == "waiting":
            fail_in(self)
        return True


class Shaky(AbstractModifier):
    """A modifier that fails."""

    def modify(self) -> None:
        fail_in(self.component_instance)


class Line(AbstractDatastream):
    """A stream that fails."""

    finalized = False

    def default(self, ci: Any = None) -> bool:
        if self.kwargs.get("fails"):
            fail_in(self.component_instance)
        self.kwargs.setdefault("sent", []).append(self.component_instance.clock.tick)
        return self.direction == "IN"

    def finalize(self) -> None:
        self.finalized = True
        if self.kwargs.get("fails"):
            fault()


class Cable(DatastreamManager):
    """A middleware."""

    where = ""

    def make_stream(self, component: Any, declaration: Any) -> Line:
        return Line(component, declaration.options)

    def action(self) -> None:
        if self.where == "manager action" and self.context.clock.tick >= TICK:
            fault()

    def flush(self) -> None:
        if self.where == "manager flush" and self.context.clock.tick >= TICK:
            fault()


class Watcher(Observer):
    """An observer that fails in the method of that name."""

    def __init__(self, simulation: Any, method: str) -> None:
        self.calls = 0

        def failing(*_arguments: Any) -> None:
            if simulation.ticks >= TICK:
                self.calls += 1
                fault()

        setattr(self, method, failing)

    def close(self) -> None:
        fault()


def here() -> str:
    """The file of the errors under test."""
    return sys.modules[fault.__module__].__file__ or ""
