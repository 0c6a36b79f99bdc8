"""A forward-looking sonar."""

from __future__ import annotations

import math
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from morse.core.declarations import BuilderDefaults, Visual
from morse.helpers.components import add_data, add_kind, add_property, prop
from morse.plugins.senses.scanning import (
    ScanningSensor,
    acoustic_reflectivity,
    by_object,
    dot,
    echoes_by_range,
    grid,
    picture,
    steps,
)
from morse.plugins.senses.water import absorption, sound_speed, transmission_loss

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]


def _azimuths(sonar: ImagingSonar) -> Floats:
    return np.array(steps(math.radians(sonar.fov), sonar.beams)[::-1])


def _ranges(sonar: ImagingSonar) -> Floats:
    return np.asarray((np.arange(sonar.bins) + 0.5) * (sonar.max_range / sonar.bins), dtype=np.float64)


class ImagingSonar(ScanningSensor):
    """An image of the echoes by range and angle, with shadows behind what reflects.

    An echo of a surface has the power μ cos²θ dA / r⁴ · 10^(-α r / 5): Lambert's law for the angle θ to the normal
    (Urick, chapter 8), spreading and absorption on both ways. The receiver amplifies by the range, 20 log r + 2 α r +
    ``gain``, so that equal surfaces look equal; pixels are proportional to the amplitude, and 255 is a wall across the
    whole beam without gain. With ``errors``, each cell has speckle, whose amplitude has a Rayleigh distribution, and
    the noise of the receiver, which the amplification raises with the range. μ is the property
    ``acoustic_reflectivity`` of the object.
    """

    _name = "Imaging sonar"
    _short_desc = "Multibeam forward-looking sonar: an image by range and angle"
    _source = "Urick, Principles of Underwater Sound; Ainslie and McColm 1998"
    _builder = BuilderDefaults(frequency=10.0, visual=Visual("cube", (0.06, 0.06, 0.04), (0.1, 0.1, 0.1)))
    _products = (
        BuilderDefaults(
            "OculusM750d",
            frequency=10.0,
            visual=Visual("cube", (0.06, 0.06, 0.04), (0.1, 0.1, 0.1)),
            properties={
                "beams": 512,
                "bins": 400,
                "fov": 130.0,
                "elevation": 20.0,
                "max_range": 40.0,
                "carrier": 750e3,
                "errors": True,
            },
            doc="A Blueprint Subsea Oculus M750d at 750 kHz: 512 beams, 130 x 20 degrees, up to 120 m.",
            source="data sheet of the Oculus M750d (Blueprint Subsea)",
        ),
    )

    add_data(
        "image",
        np.zeros((0, 0), np.uint8),
        "buffer",
        "Amplitude of the echoes: a row for each range, the nearest first; a column for each beam, the leftmost first",
        shape=(None, None),
        dtype="uint8",
        low=0,
        high=255,
    )
    add_property("beams", 512, "beams", "integer", "Number of beams", low=2, high=1024)
    add_property("bins", 256, "bins", "integer", "Number of range cells", low=8, high=1024)
    add_property("elevation_rays", 24, "elevation_rays", "integer", "Rays of a beam", low=1, high=64)
    add_property("fov", 130.0, "fov", "float", "Full angle from left to right", unit="deg", low=1.0, high=180.0)
    add_property("elevation", 20.0, "elevation", "float", "Full angle up and down", unit="deg", low=0.1, high=90.0)
    add_property("max_range", 30.0, "max_range", "float", "Largest distance", unit="m", low=0.5, high=1e3)
    add_property("carrier", 750e3, "carrier", "float", "Frequency", unit="Hz", low=1e4, high=5e6)
    add_property("gain", 18.0, "gain", "float", "Amplification", unit="dB", low=-60.0, high=100.0)
    add_property(
        "noise", -50.0, "noise", "float", "Of the receiver at the largest range", unit="dB", low=-200.0, high=40.0
    )
    add_property("temperature", 10.0, "temperature", "float", "Of the water", unit="°C", low=-2.0, high=40.0)
    add_property("salinity", 35.0, "salinity", "float", "Of the water, parts per thousand", low=0.0, high=45.0)
    add_property("errors", False, "errors", "bool", "Speckle, and noise of the receiver")

    add_kind(
        "sonar_image",
        pixels="image",
        azimuths=_azimuths,
        ranges=_ranges,
        frequency=prop("carrier"),
        sound_speed=lambda sonar: sonar.sound_speed(),
    )

    shaping = ("beams", "elevation_rays", "fov", "elevation", "max_range")
    beams: int
    bins: int
    elevation_rays: int
    fov: float
    elevation: float
    max_range: float
    carrier: float
    gain: float
    noise: float
    temperature: float
    salinity: float
    errors: bool

    def directions(self) -> Floats:
        """Return a fan for each elevation, from the left to the right."""
        return grid(_azimuths(self).tolist(), steps(math.radians(self.elevation), self.elevation_rays))

    def reach(self) -> float:
        """Return the largest distance, m."""
        return self.max_range

    def cell_count(self) -> float:
        """Return the number of pixels of the image."""
        return float(self.beams * self.bins)

    def ray_count(self) -> float:
        """Return the number of rays."""
        return float(self.beams * self.elevation_rays)

    def sound_speed(self) -> float:
        """Return the speed of sound at the depth of the sensor below z = 0, m/s."""
        return sound_speed(self.temperature, self.salinity, max(-self.position_3d.z, 0.0))

    def measure(self) -> None:
        """Measure the image."""
        rays = self.scan()
        shape = (self.elevation_rays, self.beams)
        hit = rays.hit.reshape(shape)
        cosine = np.clip(-dot(rays.normals, rays.directions), 0.0, 1.0)
        # the area of a ray is r² / cos θ times its angle; with the spreading both ways and the gain, r is left out
        power = (by_object(rays, acoustic_reflectivity) * cosine).reshape(shape) / self.elevation_rays
        cells = np.where(hit >= 0, np.minimum(rays.ranges / self.max_range, 1.0).reshape(shape) * self.bins, self.bins)
        bins = np.minimum(cells.astype(np.int64), self.bins)
        power = echoes_by_range(bins, power, (hit[:-1] == hit[1:]) & (hit[:-1] >= 0), self.bins)
        if self.errors:
            random = self.tick_random("speckle")
            power = power * random.standard_exponential(power.shape)
            power += random.standard_exponential(power.shape) * self._noise_by_range()[:, None]
        amplitude = np.sqrt(power) * (255.0 * 10.0 ** (self.gain / 20.0))
        self.local_data["image"] = np.minimum(amplitude, 255.0).astype(np.uint8)

    def _noise_by_range(self) -> Floats:
        """Return the power of the noise in each range cell after the amplification."""
        alpha = absorption(self.carrier, self.temperature, max(self.salinity, 1e-3), max(-self.position_3d.z, 0.0))
        far = 2.0 * transmission_loss(self.max_range, alpha) - 20.0 * math.log10(self.max_range)
        levels = [
            self.noise + 2.0 * transmission_loss(r, alpha) - 20.0 * math.log10(r) - far for r in _ranges(self).tolist()
        ]
        return np.array([10.0 ** (max(level, -300.0) / 10.0) for level in levels])

    def noisy_fields(self) -> tuple[str, ...]:
        """Return no fields, because ``errors`` determines the noise."""
        return ()

    def shown(self) -> dict[str, object]:
        """The image as a fan, ahead upwards."""
        image = np.asarray(self.local_data["image"])
        if not image.size:
            return {}
        cells = _fan(image.shape[0], image.shape[1], self.fov)
        grey = np.where(cells >= 0, image.ravel()[np.maximum(cells, 0)], 30)
        amber = grey[..., None] * np.array([1.0, 0.75, 0.35])
        return picture(amber.astype(np.uint8), self.local_data)


@lru_cache(maxsize=16)
def _fan(bins: int, beams: int, fov: float, height: int = 256) -> NDArray[np.int64]:
    """The cell (H, W) of each pixel of a picture of a fan; -1 outside."""
    half = math.radians(fov) / 2.0
    side = math.sin(min(half, math.pi / 2.0))
    width = max(2 * round(height * side), 2)
    y, x = np.mgrid[0:height, 0:width]
    ahead = (height - 0.5 - y) / height
    left = (width / 2.0 - 0.5 - x) / height
    distance = np.sqrt(ahead**2 + left**2)
    table = [math.atan2(a, b) for a, b in zip(left.ravel().tolist(), ahead.ravel().tolist(), strict=True)]
    angle = np.array(table).reshape(left.shape)
    column = np.floor((half - angle) / (2.0 * half) * beams).astype(np.int64)
    row = np.floor(distance * bins).astype(np.int64)
    inside = (column >= 0) & (column < beams) & (row < bins)
    return np.where(inside, row * beams + column, -1)
