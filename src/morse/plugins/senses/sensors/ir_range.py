"""An infrared distance sensor with an analogue output."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from morse.core.declarations import BuilderDefaults, Visual
from morse.helpers.components import add_data, add_kind, add_property, prop
from morse.plugins.senses.scanning import ScanningSensor

if TYPE_CHECKING:
    from numpy.typing import NDArray


class IRRange(ScanningSensor):
    """Measures the distance by triangulation: a voltage that falls with the distance, and what a program makes of it.

    The voltage is (d / ``scale``)^(-1 / ``exponent``), which describes the curve of the data sheet between the smallest
    and the largest distance. Nearer than ``min_range`` the voltage falls again, as in the real sensor: the distance is
    then too large. Beyond the largest distance it is that of the largest distance.
    """

    _name = "Infrared range sensor"
    _short_desc = "Distance by infrared triangulation, with its voltage"
    _source = "curve of the GP2Y0A21YK0F (Sharp): d = 27.728 cm V^-1.2045, a common fit"
    _builder = BuilderDefaults(frequency=26.0, visual=Visual("cube", (0.007, 0.022, 0.007), (0.1, 0.1, 0.1)))
    _products = (
        BuilderDefaults(
            "SharpGP2Y0A21",
            frequency=26.0,
            visual=Visual("cube", (0.007, 0.022, 0.007), (0.1, 0.1, 0.1)),
            properties={"errors": True},
            doc="A Sharp GP2Y0A21YK0F: 10 to 80 cm, 26 Hz, with its noise.",
            source="data sheet of the GP2Y0A21YK0F (Sharp)",
        ),
    )

    add_data("voltage", 0.0, "float", "Of the output", unit="V", low=0.0, high=5.0)
    add_data("distance", 0.0, "float", "By the curve; infinite beyond the largest distance", unit="m", low=0.0,
             allow=("inf",), follows="voltage")  # fmt: skip

    add_property("min_range", 0.1, "min_range", "float", "Smallest distance", unit="m", low=0.01, high=10.0)
    add_property("max_range", 0.8, "max_range", "float", "Largest distance", unit="m", low=0.02, high=10.0)
    add_property("scale", 0.27728, "scale", "float", "Distance at 1 V", unit="m", low=0.01, high=10.0)
    add_property("exponent", 1.2045, "exponent", "float", "Of the curve", low=0.5, high=3.0)
    add_property("errors", False, "errors", "bool", "With noise of 20 mV, and steps of 10 bits of 5 V")

    add_kind("range", distance="distance", min=prop("min_range"), max=prop("max_range"), fov=0.05, radiation="infrared")

    shaping = ("max_range",)
    min_range: float
    max_range: float
    scale: float
    exponent: float
    errors: bool

    def directions(self) -> NDArray[np.float64]:
        """Return the ray ahead."""
        return np.array([[1.0, 0.0, 0.0]])

    def reach(self) -> float:
        """Return the largest distance, m."""
        return self.max_range

    def ray_count(self) -> float:
        """Return one ray."""
        return 1.0

    def voltage_at(self, distance: float) -> float:
        """Return the voltage at a distance (m), V."""
        if distance < self.min_range:
            return self.voltage_at(self.min_range) * distance / self.min_range
        return min(math.pow(min(distance, self.max_range) / self.scale, -1.0 / self.exponent), 5.0)

    def measure(self) -> None:
        """Measure the voltage."""
        voltage = self.voltage_at(float(self.scan().ranges[0]))
        if self.errors:
            step = 5.0 / 1023.0
            voltage = round((voltage + 0.02 * float(self.tick_random("voltage").standard_normal())) / step) * step
        self.local_data["voltage"] = min(max(voltage, 0.0), 5.0)

    def report(self) -> None:
        """Compute the distance."""
        voltage = max(self.local_data["voltage"], 1e-3)
        distance = self.scale * math.pow(voltage, -self.exponent)
        self.local_data["distance"] = distance if distance < self.max_range * (1.0 - 1e-9) else math.inf
