"""Charging stations."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from morse.core.classes.builder_defaults import RobotDefaults
from morse.core.services import service
from morse.helpers.components import add_data, add_property
from morse.plugins.facilities.panels import Facility
from morse.sensors.battery import ChargingPoint

if TYPE_CHECKING:
    from collections.abc import Sequence

#: m: a battery is not charged from another floor
_HIGH = 2.0


class Charger(Facility, ChargingPoint):
    """A charging station: the batteries within its reach gain charge while it is switched on."""

    _name = "Charger"
    _short_desc = "A station that charges the batteries of robots that stand on it"
    _builder = RobotDefaults(drive="free", builder="morse.plugins.facilities.handling.Charger")

    add_data("on", True, "bool", "Whether it charges")
    add_data("robots", [], "list", "Names of the robots that stand on its pad")

    _rate: float
    _reach: float
    add_property("_rate", 1.0, "Rate", "float", "Charge that a battery gains", unit="%/s", low=0.0, high=1e4)
    add_property("_reach", 0.5, "Reach", "float", "Distance of a battery from its middle", unit="m", low=0.0, high=50.0)

    @service
    def switch(self, on: bool) -> None:
        """Switch the station on or off."""
        self.local_data["on"] = on

    def charging_rate(self, position: Sequence[float]) -> float | None:
        """Return the charge, % per second, that a battery at a position gains; None out of reach."""
        return self._rate if self.local_data["on"] and self._reaches(position) else None

    def _reaches(self, position: Sequence[float]) -> bool:
        x, y, z = (a - b for a, b in zip(position, self.bge_object.world_pose()[0], strict=True))
        return math.hypot(x, y) <= self._reach and -0.5 <= z <= _HIGH

    def default_action(self) -> None:
        """Look who stands there."""
        self.local_data["robots"] = [
            name
            for name, robot in self.context.robots.items()
            if not isinstance(robot, Facility) and self._reaches(robot.bge_object.world_pose()[0])
        ]
