"""Components of users, for the tests of the live view."""

from __future__ import annotations

import time

from morse.core.declarations import add_property
from morse.core.sensor import Sensor


class Camera(Sensor):
    """Takes pictures, or pauses to."""

    add_property("capturing", True, "capturing", "bool", "whether it takes pictures")


class Writer(Sensor):
    """Keeps things in the properties of its robot, some of them awkward."""

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
    """Cannot be written."""

    def __repr__(self) -> str:
        raise RuntimeError("it is broken")
