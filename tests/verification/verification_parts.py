"""Components of users: some are repeatable, some are not."""

import random
import time
from typing import Any

from morse.core.actuator import Actuator
from morse.core.declarations import add_data, add_property
from morse.core.sensor import Sensor


class Wander(Actuator):
    """Drives its robot at random speeds, which are determined by the seed of the scene."""

    add_property("_kind", "Velocity", "Kind", "string", "Velocity or Position")
    _kind: str

    def __init__(self, obj: Any, parent: Any = None) -> None:
        super().__init__(obj, parent)
        self._random = self.context.random(self.name())
        self._speeds = (0.0, 0.0)

    def default_action(self) -> None:
        if self.clock.tick % 20 == 0:
            self._speeds = (self._random.uniform(-0.5, 2.0), self._random.uniform(-1.5, 1.5))
        v, w = self._speeds
        self.drive(v, w)

    def drive(self, v: float, w: float) -> None:
        self.robot_parent.apply_speed(self._kind, (v, 0.0, 0.0), (0.0, 0.0, w))


class WheelWander(Wander):
    """The same with the wheels of the robot."""

    def drive(self, v: float, w: float) -> None:
        self.robot_parent.apply_vw_wheels(v, w)


class Fair(Sensor):
    """Measures constants."""

    add_data("value", 0.0, "float", "")
    add_data("names", None, "", "")

    def default_action(self) -> None:
        self.local_data["value"] = self.position_3d.x


class WallClock(Fair):
    """From its fifth measurement on, uses the wall clock."""

    def default_action(self) -> None:
        if self.clock.tick >= 5:
            self.local_data["value"] = time.time()


class Dice(Fair):
    """Throws dice from an unseeded generator, once per second."""

    def default_action(self) -> None:
        if self.clock.tick % 60 == 0:
            self.local_data["value"] = random.random()


class Sets(Fair):
    """Uses the first of a set of names."""

    def default_action(self) -> None:
        if self.clock.tick >= 3:
            self.local_data["names"] = next(iter({"anna", "bert", "carl", "dora", "emil", "fred"}))


class Memory(Fair):
    """Stores earlier runs in its class."""

    runs = 0

    def __init__(self, obj: Any, parent: Any = None) -> None:
        super().__init__(obj, parent)
        Memory.runs += 1

    def default_action(self) -> None:
        if self.clock.tick >= 8:
            self.local_data["value"] = float(Memory.runs)


class Shaky(Sensor):
    """Pushes its robot depending on the wall clock."""

    def default_action(self) -> None:
        if self.clock.tick == 7:
            self.robot_parent.bge_object.applyForce((1e-3 * (time.time() % 1.0), 0.0, 0.0))


class Unwritable(Fair):
    """Has data that cannot be encoded."""

    def default_action(self) -> None:
        self.local_data["value"] = [object(), 10**40, {1: {2, 3}}, {"b", "a"}]
        self.local_data["value"].append(self.local_data["value"])
