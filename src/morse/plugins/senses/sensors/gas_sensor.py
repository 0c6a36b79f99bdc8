"""A gas sensor, and the plumes that it finds."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from morse.core.declarations import BuilderDefaults, Visual
from morse.core.sensor import Sensor
from morse.helpers.air import wind
from morse.helpers.components import add_data, add_property
from morse.mathutils.portable import exp
from morse.plugins.senses.scanning import number_of
from morse.plugins.senses.sources import sources

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

#: puffs whose random numbers come from one generator, and most puffs of a source
_BLOCK, _MOST = 256, 2000


class GasSensor(Sensor):
    """Measures the concentration of gas that sources emit as puffs, which the wind carries.

    An object with the property ``gas_source`` (g/s) emits a puff each ``interval``. A puff of the age t has drifted
    with the wind, and with a velocity of its own, whose deviation is ``turbulence``; its gas has the distribution
    of diffusion: C = m (4 π D t)^(-3/2) exp(-r² / 4 D t). Without turbulence, many puffs are the plume of a point
    source in a uniform wind, Q / (4 π D r) exp(-u (r - x) / 2 D) (J. Crank, "The Mathematics of Diffusion", section
    3.3; O. Sutton, "Micrometeorology", 1953). The wind is the present mean wind of the weather, plus ``wind_x`` and
    ``wind_y`` (m/s) of the properties of the environment. The puffs depend on the seed and their number alone: all
    sensors find the same plume.
    """

    _name = "Gas sensor"
    _short_desc = "Concentration of gas in plumes of puffs"
    _source = "Gaussian puffs: Sutton, Micrometeorology, 1953"
    _builder = BuilderDefaults(frequency=10.0, visual=Visual("cylinder", (0.02, 0.02, 0.02), (0.7, 0.7, 0.7)))

    add_data("concentration", 0.0, "float", "Of the gas", unit="g/m^3", low=0.0)
    add_property("diffusion", 0.05, "diffusion", "float", "D", unit="m^2/s", low=1e-4, high=1e3)
    add_property(
        "turbulence", 0.2, "turbulence", "float", "Deviation of the velocity of a puff", unit="m/s", low=0.0, high=100.0
    )
    add_property("interval", 0.2, "interval", "float", "Time between two puffs", unit="s", low=0.01, high=60.0)
    add_property(
        "lifetime", 60.0, "lifetime", "float", "Time after which a puff counts no more", unit="s", low=1.0, high=3600.0
    )

    diffusion: float
    turbulence: float
    interval: float
    lifetime: float

    def measure(self) -> None:
        """Measure the concentration."""
        now = self.clock.time
        last = math.floor(now / self.interval)
        count = min(math.floor(self.lifetime / self.interval), _MOST, last + 1)
        numbers = np.arange(last - count + 1, last + 1)
        ages = now - numbers * self.interval
        fresh = ages > 0.0
        numbers, ages = numbers[fresh], ages[fresh]
        air = np.array(wind(self.context, gusts=False))
        position = np.array(self.bge_object.world_pose()[0])
        total = 0.0
        for source in sources(self, "gas_source"):
            rate = number_of(source.body, "gas_source", 0.0, high=1e9)
            away = position - np.array(source.body.world_pose()[0])
            drift = air + self.turbulence * self._velocities(source.body.name, numbers)
            gap = away - drift * ages[:, None]
            width = 4.0 * self.diffusion * ages
            share = exp(-np.minimum((gap[:, 0] ** 2 + gap[:, 1] ** 2 + gap[:, 2] ** 2) / width, 700.0))
            total += float((rate * self.interval * share / (math.pi * width * np.sqrt(math.pi * width))).sum())
        self.local_data["concentration"] = total

    def _velocities(self, source: str, numbers: NDArray[np.int64]) -> Floats:
        """Return standard normal numbers (N, 3) that depend on the seed, the source and the number of each puff."""
        if not len(numbers):
            return np.zeros((0, 3))
        blocks = range(int(numbers[0]) // _BLOCK, int(numbers[-1]) // _BLOCK + 1)
        random = self.context.random
        rows = [random(f"{source}/gas/{block}").standard_normal((_BLOCK, 3)) for block in blocks]
        return np.concatenate(rows)[numbers - blocks[0] * _BLOCK]
