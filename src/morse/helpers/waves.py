"""Waves of the sea: a sum of regular waves with the spectrum JONSWAP."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from itertools import product
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Mapping


Triple = tuple[float, float, float]

#: added mass of rectangular plates by the ratio of their sides (DNV-RP-N103)
_RATIOS = (1.0, 1.25, 1.5, 1.59, 2.0, 2.5, 3.0, 4.0, 5.0, 6.25, 8.0, 10.0, 1000.0)
_PLATES = (0.579, 0.642, 0.690, 0.704, 0.757, 0.801, 0.830, 0.871, 0.897, 0.917, 0.934, 0.947, 1.0)


@dataclass(frozen=True)
class Hull:
    """A box that approximates a vessel.

    Attributes:
        centre: position in the frame of the body, m.
        size: lengths along the axes of the body, m.
        drag: force divided by the square of the speed, along the axes of the body, kg/m.
    """

    centre: Triple
    size: Triple
    drag: Triple

    @cached_property
    def cells(self) -> list[Triple]:
        """The centres of the eight parts of the box, in the frame of the body, m."""
        cx, cy, cz = self.centre
        a, b, c = (part / 4.0 for part in self.size)
        return [(cx + i * a, cy + j * b, cz + k * c) for i, j, k in product((-1, 1), repeat=3)]

    @cached_property
    def added(self) -> Triple:
        """The added mass along each axis of the submerged box, as a share of the mass of water that it displaces.

        For a plate with the cross-section of the box, a by b with a < b: C(b/a) pi/4 a^2 b, with the coefficients of
        DNV-RP-N103, "Modelling and analysis of marine operations", appendix A (rectangular plates).
        """
        x, y, z = self.size
        shares = []
        for along, one, other in ((x, y, z), (y, x, z), (z, x, y)):
            short, long = sorted((one, other))
            coefficient = float(np.interp(long / short, _RATIOS, _PLATES))
            shares.append(coefficient * math.pi / 4.0 * short / along)
        return shares[0], shares[1], shares[2]


#: number of regular waves; and the range of their frequencies, in units of the peak
_COUNT, _LOW, _HIGH = 24, 0.6, 2.6
#: of the spectrum: peak enhancement, and width of the peak below and above it
_GAMMA, _BELOW, _ABOVE = 3.3, 0.07, 0.09
#: properties of an environment
HEIGHT, PERIOD, DIRECTION = "WaveHeight", "WavePeriod", "WaveDirection"


class _Wave(NamedTuple):
    amplitude: float
    rate: float
    along_x: float
    along_y: float
    phase: float


class Sea:
    """The height of the surface at each place and time.

    All waves run in one direction over deep water: k = w^2 / g. Spectrum: K. Hasselmann et al., "Measurements of
    wind-wave growth and swell decay during the Joint North Sea Wave Project (JONSWAP)", 1973, with the mean peak
    enhancement 3.3.

    Args:
        height: significant height of the waves, four standard deviations of the surface, m.
        period: of the highest waves, s.
        direction: towards which they run, rad from the X axis.
        gravity: m/s^2.
        random: generator of their phases.
    """

    def __init__(
        self, height: float, period: float, direction: float, gravity: float, random: np.random.Generator
    ) -> None:
        peak = 2.0 * math.pi / period
        step = (_HIGH - _LOW) * peak / _COUNT
        # frequencies that are not multiples of one: the sea does not repeat itself
        rates = [_LOW * peak + (k + float(random.uniform(0.1, 0.9))) * step for k in range(_COUNT)]
        powers = [_density(rate / peak) for rate in rates]
        scale = height * height / 16.0 / sum(powers)
        along_x, along_y = math.cos(direction) / gravity, math.sin(direction) / gravity
        self._waves = [
            _Wave(
                math.sqrt(2.0 * power * scale),
                rate,
                rate * rate * along_x,
                rate * rate * along_y,
                float(random.uniform(0.0, 2.0 * math.pi)),
            )
            for rate, power in zip(rates, powers, strict=True)
        ]

    @classmethod
    def of(cls, properties: Mapping[str, object], gravity: float, random: np.random.Generator) -> Sea | None:
        """Return the sea of an environment; None if it is calm, or if there is no gravity."""
        height, period, direction = (
            float(str(properties.get(name, default)))
            for name, default in ((HEIGHT, 0.0), (PERIOD, 6.0), (DIRECTION, 0.0))
        )
        if not (height > 0.0 and period > 0.0 and gravity > 0.0 and math.isfinite(height + period + direction)):
            return None
        return cls(height, period, direction, gravity, random)

    def at(self, x: float, y: float, time: float) -> tuple[float, float]:
        """Return the height of the surface above the calm one, m, and the speed at which it rises, m/s."""
        height = rise = 0.0
        for amplitude, rate, along_x, along_y, phase in self._waves:
            angle = along_x * x + along_y * y - rate * time + phase
            height += amplitude * math.cos(angle)
            rise += amplitude * rate * math.sin(angle)
        return height, rise


def _density(ratio: float) -> float:
    """Spectral density by the ratio of a frequency to the peak, of any scale."""
    width = _BELOW if ratio <= 1.0 else _ABOVE
    peak = math.exp(-((ratio - 1.0) ** 2) / (2.0 * width * width))
    return float(ratio**-5.0 * math.exp(-1.25 * ratio**-4.0) * _GAMMA**peak)
