"""Turntables."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Annotated

import numpy as np

from morse.core.classes.builder_defaults import RobotDefaults
from morse.core.services import service
from morse.core.validation.arguments import Range
from morse.helpers.components import add_data, add_property, add_state
from morse.plugins.facilities.panels import BeltSpeed, Facility, Panels, approach

if TYPE_CHECKING:
    from morse.core.robot import Robot
    from morse.core.values import StateData
    from morse.core.world import Body


class Turntable(Facility):
    """A disc that turns what lies on it, with a belt along its X axis that may run in any position of the disc."""

    _name = "Turntable"
    _short_desc = "A disc that turns objects, with a belt on it"
    _builder = RobotDefaults(drive="free", builder="morse.plugins.facilities.handling.Turntable")

    add_data("angle", 0.0, "float", "Angle of the disc", unit="rad", low=-math.pi, high=math.pi, angle=True)
    add_data("rate", 0.0, "float", "Angular velocity of the disc", unit="rad/s", low=-20.0, high=20.0)
    add_data("belt", 0.0, "float", "Speed of the belt along the X axis of the disc", unit="m/s", low=-10.0, high=10.0)
    add_data("state", "stopped", "string", "stopped or turning")

    _speed: float
    _acceleration: float
    add_property("_speed", 0.8, "Speed", "float", "Angular velocity", unit="rad/s", low=0.01, high=20.0)
    add_property(
        "_acceleration", 1.0, "Acceleration", "float", "Angular acceleration", unit="rad/s^2", low=0.01, high=100.0
    )

    add_state("_left", float | None, "Angle that it still has to turn, rad; None if it turns without end or stands")
    add_state("_rate", float, "Angular velocity that it approaches without end, rad/s")

    def __init__(self, obj: Body, parent: Robot | None = None) -> None:
        super().__init__(obj, parent)
        self._panels = Panels(self.context, obj)
        self._left: float | None = None
        self._rate = 0.0

    @service
    def turn_to(self, angle: Annotated[float, Range(-100.0, 100.0, "rad")]) -> None:
        """Turn the disc to an angle, on the shorter way, and stop there."""
        apart = math.remainder(angle - self.local_data["angle"], 2.0 * math.pi)
        self._left, self._rate = apart, 0.0

    @service
    def turn(self, rate: Annotated[float, Range(-20.0, 20.0, "rad/s")]) -> None:
        """Turn the disc without end; 0 stops it."""
        self._left, self._rate = None, rate

    @service
    def run(self, speed: BeltSpeed) -> None:
        """Let the belt on the disc run at a speed, m/s; 0 stops it."""
        self.local_data["belt"] = speed

    @service(changes=False)
    def objects(self) -> list[str]:
        """Names of the objects that lie on the disc."""
        return self._panels.objects_on(0)

    def default_action(self) -> None:
        """Turn for a tick."""
        data, period = self.local_data, self.clock.period
        step = self._acceleration * period
        if self._left is None:
            rate = approach(data["rate"], self._rate, step)
        else:
            # the rate from which it can just stop
            most = min(math.sqrt(2.0 * self._acceleration * abs(self._left)), self._speed)
            rate = approach(data["rate"], math.copysign(most, self._left), step)
        turned, data["rate"] = rate * period, rate
        if self._left is not None:
            if rate * self._left >= 0.0 and abs(turned) >= abs(self._left):
                turned, data["rate"], self._left = self._left, 0.0, None
            else:
                self._left -= turned
        if turned:
            data["angle"] = math.remainder(data["angle"] + turned, 2.0 * math.pi)
            self._show()
        data["state"] = "turning" if turned else "stopped"
        if turned or data["belt"]:
            linear, turning = np.zeros((self._panels.count, 3)), np.zeros(self._panels.count)
            linear[0, :2] = data["belt"] * math.cos(data["angle"]), data["belt"] * math.sin(data["angle"])
            turning[0] = turned / period
            self._panels.move_surfaces(linear, turning)

    def _show(self) -> None:
        places = self._panels.start.copy()
        angles = np.zeros(len(places))
        angles[0] = self.local_data["angle"]
        self._panels.place(places, angles)

    def set_state(self, state: StateData) -> None:
        """Restore a state, and the disc with it."""
        super().set_state(state)
        self._show()
