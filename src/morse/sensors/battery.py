"""Charge of a battery."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.core.declarations import BuilderDefaults, Visual
from morse.core.sensor import Sensor
from morse.helpers.components import add_data, add_kind, add_property, add_state, mapped

if TYPE_CHECKING:
    from morse.core.robot import Robot
    from morse.core.world import Body


class Battery(Sensor):
    """Simulates a battery that discharges at a constant rate, and charges at the same rate in a ``Charging`` zone."""

    _name = "Battery"
    _short_desc = "A battery that discharges with time, and is charged in a zone of the type Charging"
    _builder = BuilderDefaults(visual=Visual("cylinder", (0.01, 0.01, 0.04), (0.2, 0.2, 0.2)))

    add_data("charge", 100.0, "float", "Remaining charge", unit="%", low=0.0, high=100.0)
    add_data("status", "Charged", "string", "Charging, Charged or Discharging")
    add_property("_discharging_rate", 0.05, "DischargingRate", "float", "Charge lost or gained per second, %", low=0.0)
    add_kind(
        "battery",
        charge="charge",
        status=mapped("status", charging="Charging", discharging="Discharging", full="Charged"),
    )

    add_state("_time", float, "Time of the last measurement", unit="s")

    _discharging_rate: float

    def __init__(self, obj: Body, parent: Robot | None = None) -> None:
        super().__init__(obj, parent)
        self._time = self.clock.time

    def measure(self) -> None:
        """Update the charge for the time since the last measurement."""
        change = (self.clock.time - self._time) * self._discharging_rate
        self._time = self.clock.time
        data = self.local_data
        if self.in_zones(type="Charging"):
            data["charge"] = min(data["charge"] + change, 100.0)
            data["status"] = "Charged" if data["charge"] >= 100.0 else "Charging"
        else:
            data["charge"] = max(data["charge"] - change, 0.0)
            data["status"] = "Discharging"
