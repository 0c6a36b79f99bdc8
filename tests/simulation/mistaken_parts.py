"""Sensors with typical mistakes."""

import itertools
import signal
from collections.abc import Iterator
from typing import Any

from morse.core.datastream import AbstractDatastream, DatastreamManager
from morse.core.declarations import add_data
from morse.core.modifier import AbstractModifier
from morse.core.request_manager import RequestManager
from morse.core.sensor import Sensor
from morse.core.services import async_service, service


class Orphan(Sensor):
    """Does not call the constructor of its base."""

    def __init__(self, obj: Any, parent: Any = None) -> None:
        self.obj = obj


class Alone(Sensor):
    """Its constructor takes no robot."""

    def __init__(self, obj: Any) -> None:
        super().__init__(obj)


class Misspelt(Sensor):
    """Reads an attribute that does not exist."""

    def default_action(self) -> None:
        _ = self.positon_3d  # type: ignore[attr-defined]


class Sloppy(Sensor):
    """Its data do not match their declarations."""

    add_data("slope", 0.0, "float", "Angle", unit="rad")
    add_data("image", "none", "list", "Old components declare lists so")

    def default_action(self) -> None:
        self.local_data["slope"] = "steep"
        self.local_data["slop"] = 1.0
        self.local_data["image"] = [1, 2]


class Broken(list[float]):
    """Its items cannot be read."""

    def __iter__(self) -> Iterator[float]:
        raise KeyError("no items")


class Unreadable(Sensor):
    """Its data contain themselves, never end, cannot be read, and are too large."""

    for _field in ("loop", "endless", "broken", "huge"):
        add_data(_field, 0.0, "float", "A number")

    def default_action(self) -> None:
        loop: list[object] = []
        loop.append(loop)
        self.local_data["loop"] = loop
        self.local_data["endless"] = itertools.count()
        self.local_data["broken"] = Broken([1.0])
        self.local_data["huge"] = 10**400


class Named(Sensor):
    """Hides a method that every component has."""

    name = "left"  # type: ignore[assignment]


class NamedLater(Sensor):
    """Hides it while it runs."""

    add_data("x", "position at the start", "float")

    def default_action(self) -> None:
        self.name = "left"  # type: ignore[assignment,method-assign]


class Timed(Sensor):
    """Has an attribute with the name of a method that MORSE 1.4 did not have."""

    def __init__(self, obj: Any, parent: Any = None) -> None:
        super().__init__(obj, parent)
        self.progress = 0.5  # type: ignore[assignment,method-assign]


class Endless(Sensor):
    """Never returns, once Ctrl+C was pressed."""

    def default_action(self) -> None:
        signal.raise_signal(signal.SIGINT)
        while True:
            pass


class Yielding(Sensor):
    def default_action(self) -> Any:
        yield 1


class Awaited(Sensor):
    async def default_action(self) -> None:  # type: ignore[override]
        pass


class YieldingService(Sensor):
    @service
    def count(self) -> Any:
        yield 1


class AwaitedService(Sensor):
    @async_service
    async def wait(self) -> None:
        pass


class YieldingModifier(AbstractModifier):
    def modify(self) -> Any:
        yield 1


class ManagerOf14(RequestManager):
    """Takes no arguments, as the request managers of MORSE 1.4."""

    def __init__(self) -> None:
        RequestManager.__init__(self)
        self.answer_of_service: object = None

    def initialization(self) -> bool:
        return self.context is not None

    def finalization(self) -> bool:
        return True

    def on_service_completion(self, request_id: object, result: object) -> None:
        """Only synchronous calls are made."""

    def main(self) -> None:
        self.answer_of_service = self.on_incoming_request("robot.pose", "get_local_data", [])


class BrokenManager(ManagerOf14):
    def __init__(self) -> None:
        raise KeyError("port")


class BrokenAtStart(ManagerOf14):
    def initialization(self) -> bool:
        raise KeyError("port")


class StreamsOf14(DatastreamManager):
    """Reads its options where those of MORSE 1.4 have them."""

    def __init__(self, args: Any, kwargs: Any) -> None:
        DatastreamManager.__init__(self, args, kwargs)
        self.host = kwargs.get("host", "localhost")


class BrokenStreams(DatastreamManager):
    def __init__(self, args: Any, kwargs: Any) -> None:
        DatastreamManager.__init__(self, args, kwargs)
        self.host = kwargs["host"]


class Silent(AbstractDatastream):
    def default(self, ci: Any = None) -> None:
        """Sends nothing."""
