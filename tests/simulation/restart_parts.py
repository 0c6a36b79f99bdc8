"""Components and modifiers of users that record their events."""

from typing import Any

from morse.core.actuator import Actuator
from morse.core.declarations import add_data
from morse.core.modifier import AbstractModifier
from morse.core.overlay import MorseOverlay
from morse.core.sensor import Sensor
from morse.core.services import async_service, interruptible, noninterruptible, service

#: the events: the object, and a word
events: list[tuple[Any, str]] = []


def of_kind(kind: type, word: str) -> list[Any]:
    """The objects of a class with that event, in order."""
    return [obj for obj, happened in events if isinstance(obj, kind) and happened == word]


class Counter(Sensor):
    """Counts its ticks."""

    add_data("count", 0, "int", "ticks since the start")
    broken = False

    def __init__(self, obj: Any, parent: Any = None) -> None:
        super().__init__(obj, parent)
        if Counter.broken:
            raise OSError("the device is in use")
        events.append((self, "made"))

    def default_action(self) -> None:
        self.local_data["count"] += 1

    def finalize(self) -> None:
        events.append((self, "finalized"))


class Arm(Actuator):
    """Has services that are active until the simulation restarts."""

    add_data("v", 0.0, "float", "m/s")

    @service
    def which(self) -> int:
        return id(self)

    @interruptible
    @async_service
    def reach(self, far: float) -> None:
        """Never ends."""

    @noninterruptible
    @async_service
    def hold(self) -> None:
        """Never ends."""

    def interrupt(self) -> None:
        events.append((self, "interrupted"))
        super().interrupt()


class Clumsy(Arm):
    """Its interruption raises an exception."""

    def interrupt(self) -> None:
        raise KeyError("a mistake of the user")


class Scale(AbstractModifier):
    """Multiplies the count by ten."""

    def initialize(self) -> None:
        events.append((self, "initialized"))

    def modify(self) -> None:
        self.data["count10"] = 10 * self.data["count"]

    def finalize(self) -> None:
        events.append((self, "finalized"))


class Other(MorseOverlay):
    """The same arm with another name."""

    def name(self) -> str:
        return "other"

    @service
    def which_arm(self) -> int:
        return id(self.overlaid_object)

    def finalize(self) -> None:
        events.append((self, "finalized"))
