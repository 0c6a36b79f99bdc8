"""Components and modifiers of users, which note what happens to them."""

from __future__ import annotations

from typing import Any

from morse.core.actuator import Actuator
from morse.core.declarations import add_data
from morse.core.modifier import AbstractModifier
from morse.core.overlay import MorseOverlay
from morse.core.sensor import Sensor
from morse.core.services import async_service, interruptible, noninterruptible, service

#: what happened: the object, and the word for it
events: list[tuple[Any, str]] = []


def of_kind(kind: type, word: str) -> list[Any]:
    """The objects of a class to which that happened, in that order."""
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
    """Has services that go on until the simulation starts anew."""

    add_data("v", 0.0, "float", "m/s")

    @service
    def which(self) -> int:
        return id(self)

    @interruptible
    @async_service
    def reach(self, far: float) -> None:
        """Goes on for ever."""

    @noninterruptible
    @async_service
    def hold(self) -> None:
        """Goes on for ever."""

    def interrupt(self) -> None:
        events.append((self, "interrupted"))
        super().interrupt()


class Clumsy(Arm):
    """Cannot be interrupted without an accident."""

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
    """The same arm by another name."""

    def name(self) -> str:
        return "other"

    @service
    def which_arm(self) -> int:
        return id(self.overlaid_object)

    def finalize(self) -> None:
        events.append((self, "finalized"))
