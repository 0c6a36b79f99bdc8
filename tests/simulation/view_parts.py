"""Components of users, for the tests of the live view."""

import time
from typing import Any

from morse.core.declarations import add_property
from morse.core.exceptions import MorseRPCTypeError
from morse.core.sensor import Sensor
from morse.core.services import service


class Camera(Sensor):
    """Captures images, or pauses."""

    add_property("capturing", True, "capturing", "bool", "whether it takes pictures")
    add_property("zoom", 1.0, "zoom", "float", "1 or more")

    zoom: float

    @service
    def set_property(self, name: str, value: Any) -> None:
        """Refuse to see less than with the naked eye."""
        if name == "zoom" and value < 1.0:
            raise MorseRPCTypeError("the zoom is 1 or more")
        super().set_property(name, value)


class Writer(Sensor):
    """Stores values in the properties of its robot, some of them unusual."""

    ticks = 0

    def default_action(self) -> None:
        self.ticks += 1
        time.sleep(0.002)
        robot = self.robot_parent.bge_object
        robot["ticks"] = self.ticks
        robot["long"] = list(range(100_000))
        robot["text"] = "x" * 1000
        robot["broken"] = Broken()


class Broken:
    """Cannot be formatted."""

    def __repr__(self) -> str:
        raise RuntimeError("it is broken")
