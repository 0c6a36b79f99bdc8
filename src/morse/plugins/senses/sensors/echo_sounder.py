"""An echo sounder."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from morse.core.declarations import BuilderDefaults, Visual
from morse.helpers.components import add_data, add_kind, add_property, prop
from morse.plugins.senses.scanning import ScanningSensor
from morse.plugins.senses.water import absorption, sound_speed, transmission_loss

if TYPE_CHECKING:
    from numpy.typing import NDArray

#: rays of each ring of the beam
_RINGS = (1, 6, 12, 18)


class EchoSounder(ScanningSensor):
    """Measures the depth of the ground below by the time of the first echo in a cone about -Z.

    The instrument converts the time with ``assumed_speed``; the real speed of sound is that of Mackenzie at half the
    way down. ``level`` is the level of the echo of a flat bottom relative to that from 1 m: -2 (20 log r + α r) + 20
    log r.
    """

    _name = "Echo sounder"
    _short_desc = "Depth of the ground below by sound"
    _source = "Mackenzie 1981; Ainslie and McColm 1998; Urick, Principles of Underwater Sound"
    _builder = BuilderDefaults(frequency=10.0, visual=Visual("cylinder", (0.03, 0.03, 0.03), (0.1, 0.1, 0.1)))
    _products = (
        BuilderDefaults(
            "Ping1D",
            frequency=10.0,
            visual=Visual("cylinder", (0.02, 0.02, 0.03), (0.1, 0.1, 0.1)),
            properties={
                "beam_width": 25.0,
                "min_range": 0.3,
                "max_range": 100.0,
                "carrier": 115e3,
                "resolution": 0.005,
                "errors": True,
                "assumed_speed": 1500.0,
            },
            doc="A Blue Robotics Ping: 0.3 to 100 m, 25 degrees, 115 kHz; resolution 0.5 % of the range.",
            source="data sheet of the Ping Sonar altimeter and echosounder (Blue Robotics)",
        ),
    )

    add_data("depth", math.inf, "float", "Distance of the ground; infinite without an echo", unit="m", low=0.0,
             allow=("inf",))  # fmt: skip
    add_data("level", -math.inf, "float", "Level of the echo of a bottom at this distance, relative to 1 m", unit="dB",
             allow=("-inf",))  # fmt: skip

    add_property("beam_width", 10.0, "beam_width", "float", "Full angle", unit="deg", low=0.0, high=120.0)
    add_property("min_range", 0.1, "min_range", "float", "Nearer echoes are lost", unit="m", low=0.0, high=1e4)
    add_property("max_range", 100.0, "max_range", "float", "Largest distance", unit="m", low=0.1, high=1e4)
    add_property("carrier", 200e3, "carrier", "float", "Frequency", unit="Hz", low=1e3, high=5e6)
    add_property("temperature", 10.0, "temperature", "float", "Of the water", unit="°C", low=-2.0, high=40.0)
    add_property("salinity", 35.0, "salinity", "float", "Of the water, parts per thousand", low=0.0, high=45.0)
    add_property("assumed_speed", 0.0, "assumed_speed", "float", "Of the instrument; 0 for the right one", unit="m/s",
                 low=0.0, high=2e3)  # fmt: skip
    add_property("resolution", 0.005, "resolution", "float", "Deviation, share of the distance", low=0.0, high=1.0)
    add_property("errors", False, "errors", "bool", "With the errors of a real instrument")

    add_kind(
        "range",
        distance="depth",
        min=prop("min_range"),
        max=prop("max_range"),
        fov=prop("beam_width"),
        radiation="ultrasound",
    )

    shaping = ("beam_width", "max_range")
    beam_width: float
    min_range: float
    max_range: float
    carrier: float
    temperature: float
    salinity: float
    assumed_speed: float
    resolution: float
    errors: bool

    def directions(self) -> NDArray[np.float64]:
        """Return the rays of the cone, ring by ring from its axis."""
        half = math.radians(self.beam_width) / 2.0
        rows = []
        for ring, count in enumerate(_RINGS):
            angle = half * ring / (len(_RINGS) - 1)
            for index in range(count):
                turn = 2.0 * math.pi * index / count
                rows.append((math.sin(angle) * math.cos(turn), math.sin(angle) * math.sin(turn), -math.cos(angle)))
        return np.array(rows)

    def reach(self) -> float:
        """Return the largest distance, m."""
        return self.max_range

    def ray_count(self) -> float:
        """Return the number of rays."""
        return float(sum(_RINGS))

    def measure(self) -> None:
        """Measure the distance of the first echo."""
        rays = self.scan()
        echoes = rays.distances[rays.distances >= self.min_range]
        distance = float(echoes.min()) if len(echoes) else math.inf
        data = self.local_data
        data["depth"], data["level"] = distance, -math.inf
        if not math.isfinite(distance):
            return
        depth = max(-self.position_3d.z, 0.0) + distance / 2.0
        alpha = absorption(self.carrier, self.temperature, max(self.salinity, 1e-3), depth)
        data["level"] = -2.0 * transmission_loss(distance, alpha) + 20.0 * math.log10(max(distance, 1e-3))
        if self.assumed_speed > 0.0:
            distance *= self.assumed_speed / sound_speed(self.temperature, self.salinity, depth)
        if self.errors:
            distance *= 1.0 + self.resolution * float(self.tick_random("depth").standard_normal())
        data["depth"] = max(distance, 0.0)
