"""Conveyors."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from morse.core.classes.builder_defaults import RobotDefaults
from morse.core.services import service
from morse.helpers.components import add_data, add_property
from morse.plugins.facilities.panels import BeltSpeed, Facility, Panels, approach

if TYPE_CHECKING:
    from morse.core.robot import Robot
    from morse.core.world import Body


class Conveyor(Facility):
    """A belt that carries what lies on it by friction: straight, or along an arc.

    Boxes reach the speed of the belt as fast as friction allows: with the acceleration µ g on a level belt. On a steep
    belt they slide down as soon as the tangent of its slope is greater than µ.
    """

    _name = "Conveyor"
    _short_desc = "A straight or curved belt that carries objects by friction"
    _builder = RobotDefaults(drive="free", builder="morse.plugins.facilities.handling.Conveyor")

    add_data("speed", 0.0, "float", "Speed of the belt, forward", unit="m/s", low=-10.0, high=10.0)
    add_data("target", 0.0, "float", "Speed that it approaches", unit="m/s", low=-10.0, high=10.0)

    _speed: float
    _acceleration: float
    _radius: float
    _running: bool
    add_property("_speed", 0.5, "Speed", "float", "Speed after start", unit="m/s", low=-10.0, high=10.0)
    add_property("_acceleration", 1.0, "Acceleration", "float", "Acceleration", unit="m/s^2", low=0.01, high=100.0)
    add_property("_radius", 0.0, "Radius", "float", "Radius of the centre line, negative to the right; 0: straight",
                 unit="m", written_by="Conveyor(length, turn=...)")  # fmt: skip
    add_property("_running", True, "Running", "bool", "Whether it runs from the beginning")

    def __init__(self, obj: Body, parent: Robot | None = None) -> None:
        super().__init__(obj, parent)
        self._panels = Panels(self.context, obj)
        self._arc = float(self._radius)
        self.local_data["target"] = self.local_data["speed"] = float(self._speed) if self._running else 0.0

    @service
    def start(self) -> None:
        """Let the belt run at the property ``Speed``."""
        self.local_data["target"] = self._speed

    @service
    def stop(self) -> None:
        """Stop the belt, with its acceleration."""
        self.local_data["target"] = 0.0

    @service
    def set_speed(self, speed: BeltSpeed) -> None:
        """Let the belt run at a speed, m/s; negative backwards."""
        self.local_data["target"] = speed

    @service(changes=False)
    def objects(self) -> list[str]:
        """Names of the objects that lie on the belt."""
        return self._panels.objects_on(0)

    def default_action(self) -> None:
        """Approach the speed, and move the surface."""
        data = self.local_data
        data["speed"] = approach(data["speed"], data["target"], self._acceleration * self.clock.period)
        if not data["speed"]:
            return
        linear, turning = np.zeros((self._panels.count, 3)), np.zeros(self._panels.count)
        if self._arc:
            turning[0] = data["speed"] / self._arc
        else:
            linear[0, 0] = data["speed"]
        self._panels.move_surfaces(linear, turning)
