"""Charge of a battery."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import TYPE_CHECKING

from morse.core.declarations import BuilderDefaults, Visual
from morse.core.sensor import Sensor
from morse.helpers.components import add_data, add_kind, add_property, add_state, mapped

if TYPE_CHECKING:
    from collections.abc import Sequence

    from morse.core.robot import Robot
    from morse.core.world import Body


class ChargingPoint(ABC):
    """A robot, in the sense of a component with a body, that charges batteries: a station."""

    @abstractmethod
    def charging_rate(self, position: Sequence[float]) -> float | None:
        """Return the charge that a battery at a position (x, y, z), m, gains, % per second; None out of reach."""


class Battery(Sensor):
    """Simulates a battery that discharges at a constant rate, and charges at the same rate in a ``Charging`` zone.

    A charging station charges it at the rate of the station.
    """

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
        self._stations: list[str] = []
        self._looked_at = 0

    def measure(self) -> None:
        """Update the charge for the time since the last measurement."""
        elapsed = self.clock.time - self._time
        self._time = self.clock.time
        data = self.local_data
        rate = self._discharging_rate if self.in_zones(type="Charging") else self._station_rate()
        if rate is not None:
            data["charge"] = min(data["charge"] + elapsed * rate, 100.0)
            data["status"] = "Charged" if data["charge"] >= 100.0 else "Charging"
        else:
            data["charge"] = max(data["charge"] - elapsed * self._discharging_rate, 0.0)
            data["status"] = "Discharging"

    def _station_rate(self) -> float | None:
        """The largest rate of the stations within reach; None out of their reach."""
        robots = self.context.robots
        if len(robots) != self._looked_at:
            # stations are few, robots may be many
            self._stations = [name for name, robot in robots.items() if isinstance(robot, ChargingPoint)]
            self._looked_at = len(robots)
        if not self._stations:
            return None
        place = self.bge_object.world_pose()[0]
        rates: list[float | None] = []
        for name in self._stations:
            station = robots.get(name)
            if isinstance(station, ChargingPoint):
                rates.append(station.charging_rate(place))
        return max((rate for rate in rates if rate is not None), default=None)
