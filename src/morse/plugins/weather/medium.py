"""Light in fog, rain, snow and dust: extinction, and drops that send back an echo.

Lengths are in metres, extinction coefficients in 1/m. Sources of the formulas:

* meteorological range at a contrast of 5 %: H. Koschmieder 1924; WMO-No. 8, chapter 9;
* wavelengths in fog: I. Kim, B. McArthur, E. Korevaar, Proc. SPIE 4214 (2001): no change below 500 m;
* rain and snow on light: Recommendation ITU-R P.1814;
* sizes of drops: J. Marshall, W. Palmer, J. Meteorology 5 (1948); of flakes: K. Gunn, J. Marshall, J. Meteorology 15
  (1958);
* speeds of drops: D. Atlas, R. Srivastava, R. Sekhon, Rev. Geophysics 11 (1973);
* backscatter of fog: R. Rasshofer, M. Spies, H. Spies, Advances in Radio Science 9 (2011).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from morse.mathutils import portable

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

#: wavelengths, m
VISIBLE, LIDAR, THERMAL = 550e-9, 905e-9, 10e-6
#: -ln(0.05): the optical depth of the meteorological range
DEPTH_OF_RANGE = 2.996
#: dB of power as an exponent
_DECIBEL = math.log(10.0) / 10.0
#: greatest optical depth, one way: beyond it no number is left of the light, and its inverse would overflow
_OPAQUE = 300.0
#: number of distances in a table
_STEPS = 513
#: m, the thickness of fog, and of rain, snow and dust, above a camera: typical of radiation fog, and of the height of
#: rain in temperate climates (Recommendation ITU-R P.839)
_FOG_LAYER, _RAIN_LAYER = 200.0, 3000.0
#: m, the greatest distance of the sky
_FAR_AWAY = 1e5
#: mass extinction of mineral dust in visible light, m^2/g (J. Hand, W. Malm, J. Geophysical Research 112 (2007))
_DUST = 0.6


@dataclass(frozen=True)
class Conditions:
    """The weather at one time.

    Attributes:
        fog: meteorological range, m; infinite without fog.
        rain: rate, mm/h.
        snow: rate of the melted snow, mm/h.
        dust: concentration, g/m^3.
        wind: mean velocity in the world, m/s.
        gusts: standard deviation of the horizontal turbulence, m/s.
        wet: how wet the ground is, 0 to 1.
        snow_cover: share of the ground with snow.
        ice: share of smooth ice on the ground.
        lens_drops: mean number of drops on a lens.
    """

    fog: float = math.inf
    rain: float = 0.0
    snow: float = 0.0
    dust: float = 0.0
    wind: tuple[float, float, float] = (0.0, 0.0, 0.0)
    gusts: float = 0.0
    wet: float = 0.0
    snow_cover: float = 0.0
    ice: float = 0.0
    lens_drops: float = 0.0

    def mixed(self, other: Conditions, share: float) -> Conditions:
        """Return the conditions between these and others; ``share`` is 0 for these, and 1 for the others."""

        def between(a: float, b: float) -> float:
            return b if share >= 1.0 else a if share <= 0.0 or a == b else a + (b - a) * share

        # fog by its extinction, because its range may be infinite
        inverse = between(1.0 / self.fog, 1.0 / other.fog)
        values = {name: between(getattr(self, name), getattr(other, name)) for name in _NUMBERS}
        wind = tuple(between(a, b) for a, b in zip(self.wind, other.wind, strict=True))
        return Conditions(fog=1.0 / inverse if inverse else math.inf, wind=wind, **values)  # type: ignore[arg-type]

    def changed(self, values: Mapping[str, object]) -> Conditions:
        """Return the conditions with other values, which `morse.plugins.weather.checked` has checked."""
        return Conditions(**{**{field.name: getattr(self, field.name) for field in fields(self)}, **values})

    def extinction(self, wavelength: float = VISIBLE) -> float:
        """Return the extinction coefficient of light, 1/m: the power falls by ``exp(-extinction * distance)``."""
        fog = 0.0 if math.isinf(self.fog) else _fog(self.fog, wavelength)
        return fog + _DECIBEL / 1000.0 * (_rain(self.rain) + _snow(self.snow, wavelength)) + _DUST * self.dust

    def overhead(self, wavelength: float = VISIBLE) -> float:
        """Return the optical depth of the air above a camera."""
        fog = 0.0 if math.isinf(self.fog) else _fog(self.fog, wavelength)
        return fog * _FOG_LAYER + (self.extinction(wavelength) - fog) * _RAIN_LAYER

    def way_to_sky(self, rise: NDArray[np.float32], wavelength: float = VISIBLE) -> NDArray[np.float32]:
        """Return the lengths (N,) of air with the present extinction up to the sky, m.

        Args:
            rise: (N,) vertical components of the directions, of length 1.
            wavelength: m.
        """
        whole = self.extinction(wavelength)
        layer = self.overhead(wavelength) / whole if whole else _FAR_AWAY
        return np.asarray(np.float32(layer) / np.maximum(rise, np.float32(layer / _FAR_AWAY)), np.float32)

    @property
    def is_clear(self) -> bool:
        """Whether nothing is in the air."""
        return math.isinf(self.fog) and not (self.rain or self.snow or self.dust)


_NUMBERS = ("rain", "snow", "dust", "gusts", "wet", "snow_cover", "ice", "lens_drops")


def _fog(range_of_sight: float, wavelength: float) -> float:
    km = range_of_sight / 1000.0
    exponent = 0.0 if km < 0.5 else km - 0.5 if km < 1.0 else 0.16 * km + 0.34 if km < 6.0 else 1.3
    return float(DEPTH_OF_RANGE / range_of_sight * (wavelength / VISIBLE) ** -exponent)


def _rain(rate: float) -> float:
    """dB/km."""
    return float(1.076 * rate**0.67)


def _snow(rate: float, wavelength: float) -> float:
    """dB/km, of dry snow."""
    nanometres = min(wavelength, 1550e-9) * 1e9
    return float((0.0000542 * nanometres + 5.4958776) * rate**1.38)


class Drops(NamedTuple):
    """The sizes of drops or flakes, an exponential distribution.

    Attributes:
        intercept: number per volume and diameter, 1/(m^3 mm).
        slope: 1/mm.
        reflectance: backscattered power of a drop, as a multiple of that of a disc of its size that scatters all light.
    """

    intercept: float
    slope: float
    reflectance: float

    def number(self, diameter: float = 0.0) -> float:
        """Return the number of drops per volume that are larger than a diameter in mm, 1/m^3."""
        return self.intercept / self.slope * math.exp(-self.slope * diameter)


#: A sphere of water reflects at its front, and, focused, at its back: R (1 + (1 - R)^2 (n / (2 - n))^2) of the light on
#: its cross section, evenly into all directions (geometrical optics); a white disc sends 4 times as much straight back.
_WATER = 1.33
_FRESNEL = ((_WATER - 1.0) / (_WATER + 1.0)) ** 2
_OF_DROP = _FRESNEL * (1.0 + (1.0 - _FRESNEL) ** 2 * (_WATER / (2.0 - _WATER)) ** 2) / 4.0
#: a white sphere that scatters: 2/3 of a disc; snow scatters 90 %
_OF_FLAKE = 0.9 * 2.0 / 3.0


def drops_of(conditions: Conditions) -> list[Drops]:
    """Return the drops and flakes in the air."""
    drops = []
    if conditions.rain > 0.0:
        drops.append(Drops(8000.0, 4.1 * conditions.rain**-0.21, _OF_DROP))
    if conditions.snow > 0.0:
        drops.append(Drops(3800.0 * conditions.snow**-0.87, 2.55 * conditions.snow**-0.48, _OF_FLAKE))
    return drops


def falling_speed(diameter: float) -> float:
    """Return the speed of a raindrop, m/s; its diameter is in mm."""
    return max(9.65 - 10.3 * math.exp(-0.6 * diameter), 0.0)


@dataclass(frozen=True)
class Beam:
    """The light of a scanner: how wide it is, and what its receiver detects.

    Echoes are in units of the echo of a white surface, perpendicular to the beam, at 1 m in clear air.

    Attributes:
        reach: m; a surface that reflects ``white`` is just detected there.
        aperture: width of the beam at the scanner, m; ``divergence``: its growth, rad. Those of the VLP-16 (Velodyne,
            user manual 63-9243).
        overlap: m; what is nearer is not in the field of the receiver.
    """

    reach: float
    aperture: float = 0.011
    divergence: float = 0.0022
    white: float = 0.8
    overlap: float = 1.0

    @property
    def threshold(self) -> float:
        """The weakest echo that is detected."""
        return self.white / self.reach**2

    def through(self, conditions: Conditions) -> Passage:
        """Return what the beam meets in the air."""
        extinction = conditions.extinction(LIDAR)
        ranges = np.linspace(0.0, self.reach, _STEPS)
        rates = np.zeros(_STEPS)
        for drops in drops_of(conditions):
            rates += self.echo_rate(drops, extinction, ranges)
        step = self.reach / (_STEPS - 1)
        # the trapezoidal rule
        number = np.concatenate([[0.0], np.cumsum(0.5 * (rates[1:] + rates[:-1]))]) * step
        return Passage(self, ranges, portable.exp(-2.0 * extinction * ranges), number, self.fog_echo(conditions))

    def echo_rate(self, drops: Drops, extinction: float, ranges: Floats) -> Floats:
        """Return the number of detected drops per metre of the beam (N,) at distances (N,), 1/m."""
        width = self.aperture + self.divergence * ranges
        # a drop covers (D / width)^2 of the beam; D in mm
        loss = portable.exp(2.0 * np.minimum(extinction * ranges, _OPAQUE))
        square = self.threshold * ranges**2 * loss * width**2 / drops.reflectance
        smallest = 1000.0 * np.sqrt(square)
        rates: Floats = math.pi / 4.0 * width**2 * drops.intercept / drops.slope * portable.exp(-drops.slope * smallest)
        return np.where(ranges > self.overlap, rates, 0.0)

    def fog_echo(self, conditions: Conditions) -> tuple[float, float]:
        """Return distance, m, and strength of the strongest echo of fog droplets.

        They are too small and too many to be seen one by one: the echo of a pulse of 5 ns is that of a layer of 0.75 m.
        """
        if math.isinf(conditions.fog):
            return math.inf, 0.0
        extinction = conditions.extinction(LIDAR)
        # both factors fall with the distance
        distance = self.overlap
        # 0.046 / (m sr) at a range of sight of 1 m (Rasshofer); a white surface sends back 1 / pi
        backscatter = 0.046 / conditions.fog * math.pi * 0.75
        return distance, backscatter * math.exp(-2.0 * extinction * distance) / distance**2


@dataclass(frozen=True, eq=False)
class Passage:
    """What a beam meets in the air, as tables over the distance.

    Attributes:
        beam: the beam.
        ranges: (K,) distances, m.
        transmission: (K,) share of the light that comes back from there.
        echoes: (K,) mean number of detected drops on the way.
        fog_echo: distance, m, and strength of the echo of fog.
    """

    beam: Beam
    ranges: Floats
    transmission: Floats
    echoes: Floats
    fog_echo: tuple[float, float]

    def received(self, ranges: Floats) -> Floats:
        """Return the share of the light (N,) that comes back from distances (N,)."""
        return np.interp(ranges, self.ranges, self.transmission)

    @staticmethod
    def faded(depth: Floats) -> Floats:
        """Return the share of the light (N,) that comes back through optical depths (N,), one way."""
        return portable.exp(-2.0 * np.minimum(depth, _OPAQUE))

    def drops_within(self, start: Floats, end: Floats) -> Floats:
        """Return the mean number (N,) of detected drops between distances (N,)."""
        return np.interp(end, self.ranges, self.echoes) - np.interp(start, self.ranges, self.echoes)

    def place_of_drop(self, start: Floats, number: Floats) -> Floats:
        """Return the distance (N,) behind which there are as many detected drops (N,) from a start (N,) on."""
        return np.interp(np.interp(start, self.ranges, self.echoes) + number, self.echoes, self.ranges)

    def first_drops(self, random: np.random.Generator, count: int) -> Floats:
        """Return the distance (N,) of the first drop that each beam detects, m; infinite for none."""
        drawn = random.standard_exponential(count)
        if not self.echoes[-1]:
            return np.full(count, np.inf)
        return np.where(drawn < self.echoes[-1], np.interp(drawn, self.echoes, self.ranges), np.inf)
