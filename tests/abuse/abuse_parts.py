"""Components of users, with errors."""

import math
from typing import Any

from morse.core.actuator import Actuator
from morse.core.declarations import add_data, add_property
from morse.core.modifier import AbstractModifier
from morse.core.sensor import Sensor
from morse.core.services import async_service, interruptible, service


class Raises(Sensor):
    """Fails in its tenth measurement."""

    add_data("count", 0, "int", "measurements")

    def default_action(self) -> None:
        self.local_data["count"] += 1
        if self.local_data["count"] == 10:
            raise ZeroDivisionError("a mistake of the user")


class Explodes(Actuator):
    """Pushes its robot with an overflowing force, in the fifth tick."""

    add_property("_push", math.inf, "Push", "float", "N")
    _push: float

    def default_action(self) -> None:
        if self.clock.tick == 4:
            self.robot_parent.bge_object.applyForce((self._push, 0.0, 0.0))


class Brittle(Actuator):
    """Its services fail in every way."""

    add_data("v", 0.0, "float", "m/s")

    @service
    def fail(self) -> None:
        raise RuntimeError("a mistake of the user")

    @service
    def endless(self) -> Any:
        inner: list[Any] = []
        inner.append(inner)
        return inner

    @interruptible
    @async_service
    def fail_later(self) -> None:
        raise RuntimeError("a mistake of the user")


class Garbles(AbstractModifier):
    """Has data that cannot be sent."""

    def modify(self) -> None:
        self.data["thing"] = object()
