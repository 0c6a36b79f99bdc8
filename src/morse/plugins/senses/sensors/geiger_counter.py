"""A Geiger counter."""

from __future__ import annotations

import math

from morse.core.declarations import BuilderDefaults, Visual
from morse.core.sensor import Sensor
from morse.helpers.components import add_data, add_property
from morse.plugins.senses.scanning import number_of
from morse.plugins.senses.sources import sources, walls

#: 1/m: 0.0777 cm²/g at 662 keV (NIST, M. Berger, J. Hubbell, XCOM), 2.3 g/cm³
_CONCRETE = 17.9


class GeigerCounter(Sensor):
    """Counts the rays of radioactive sources.

    An object with the property ``activity`` (Bq) is a point source of gamma rays. The counter of the sensitive area S
    at the distance r counts the rate activity · S / 4 π r² · exp(-Σ μ d): μ is the property ``attenuation`` (1/m) of
    each object between, 17.9 1/m without it (concrete at 662 keV: 0.0777 cm²/g by NIST XCOM, 2.3 g/cm³), and d the way
    inside of it. ``counts`` are those since the last measurement; with ``errors`` they have a Poisson distribution.
    """

    _name = "Geiger counter"
    _short_desc = "Counts rays of radioactive sources behind shields"
    _source = "inverse square law, Lambert-Beer; attenuation: NIST XCOM"
    _builder = BuilderDefaults(frequency=10.0, visual=Visual("cylinder", (0.02, 0.02, 0.06), (0.8, 0.7, 0.1)))

    add_data("rate", 0.0, "float", "Expected counts", unit="Hz", low=0.0)
    add_data("counts", 0.0, "float", "Since the last measurement", low=0.0, high=1e18)
    add_property(
        "area",
        0.001,
        "area",
        "float",
        "S, times the share of the rays that are counted",
        unit="m^2",
        low=1e-8,
        high=10.0,
    )
    add_property("background", 0.3, "background", "float", "Counts without a source", unit="Hz", low=0.0, high=1e6)
    add_property("errors", False, "errors", "bool", "Counts are random")

    area: float
    background: float
    errors: bool

    def measure(self) -> None:
        """Measure the rate, and count."""
        rate = self.background
        for source in sources(self, "activity"):
            activity = number_of(source.body, "activity", 0.0, high=1e18)
            shield = sum(
                number_of(wall.body, "attenuation", _CONCRETE, high=1e4) * wall.thickness
                for wall in walls(self, source.body)
            )
            # not more than hit a sphere around the source
            share = min(self.area / (4.0 * math.pi * max(source.distance, 1e-3) ** 2), 1.0)
            rate += activity * share * math.exp(-min(shield, 700.0))
        expected = rate / max(self.frequency, 1e-3)
        self.local_data["rate"] = rate
        random = self.tick_random("counts")
        self.local_data["counts"] = float(random.poisson(min(expected, 1e15))) if self.errors else expected

    def noisy_fields(self) -> tuple[str, ...]:
        """Return no fields, because ``errors`` determines the noise."""
        return ()
