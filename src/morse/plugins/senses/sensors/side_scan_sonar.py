"""A side-scan sonar."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from morse.core.declarations import BuilderDefaults, Visual
from morse.helpers.components import add_data, add_kind, add_property
from morse.plugins.senses.scanning import (
    ScanningSensor,
    acoustic_reflectivity,
    by_object,
    dot,
    echoes_by_range,
    picture,
)

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]


class SideScanSonar(ScanningSensor):
    """An image of the bottom on both sides of the track: each ping adds a row.

    A ping measures the echoes by range on both sides, in a plane across the track from 5° below the horizontal down to
    the vertical. The formula is that of `ImagingSonar`; the columns are from the far end of the port side over the
    middle to the far end of the starboard side. With ``errors`` there is speckle.
    """

    _name = "Side-scan sonar"
    _short_desc = "An image of the bottom on both sides of the track"
    _source = "Urick, Principles of Underwater Sound, chapter 8"
    _builder = BuilderDefaults(frequency=10.0, visual=Visual("cylinder", (0.03, 0.03, 0.3), (0.8, 0.7, 0.1)))
    _products = (
        BuilderDefaults(
            "StarFish450F",
            frequency=10.0,
            visual=Visual("cylinder", (0.03, 0.03, 0.19), (0.9, 0.8, 0.1)),
            properties={"max_range": 100.0, "samples": 500, "errors": True},
            doc="A Blueprint Subsea StarFish 450F: 450 kHz, up to 100 m on each side.",
            source="data sheet of the StarFish 450F (Blueprint Subsea)",
        ),
    )

    add_data(
        "image",
        np.zeros((0, 0), np.uint8),
        "buffer",
        "Amplitude of the echoes: a row for each ping, the newest last; port on the left, starboard on the right",
        shape=(None, None),
        dtype="uint8",
        low=0,
        high=255,
    )
    add_property("pings", 256, "pings", "integer", "Number of rows that are kept", low=1, high=2048)
    add_property("samples", 256, "samples", "integer", "Number of range cells on each side", low=8, high=2048)
    add_property("ray_number", 256, "rays_per_side", "integer", "Rays on each side", low=2, high=2048)
    add_property("max_range", 50.0, "max_range", "float", "Largest distance", unit="m", low=0.5, high=1e3)
    add_property("gain", 20.0, "gain", "float", "Amplification", unit="dB", low=-60.0, high=100.0)
    add_property("errors", False, "errors", "bool", "Speckle")

    add_kind("image", pixels="image", encoding="mono8")

    shaping = ("ray_number", "max_range")
    pings: int
    samples: int
    ray_number: int
    max_range: float
    gain: float
    errors: bool

    def directions(self) -> Floats:
        """Return the rays of the port side, then those of the starboard side, from the horizontal downwards."""
        angles = [math.radians(5.0 + 85.0 * (index + 0.5) / self.ray_number) for index in range(self.ray_number)]
        port = [(0.0, math.cos(angle), -math.sin(angle)) for angle in angles]
        return np.array([*port, *((0.0, -y, z) for _, y, z in port)])

    def reach(self) -> float:
        """Return the largest distance, m."""
        return self.max_range

    def cell_count(self) -> float:
        """Return the number of pixels of the image."""
        return 2.0 * self.samples * self.pings

    def ray_count(self) -> float:
        """Return the number of rays."""
        return 2.0 * self.ray_number

    def measure(self) -> None:
        """Add a row to the image."""
        rays = self.scan()
        shape = (2, self.ray_number)
        hit = rays.hit.reshape(shape).T
        cosine = np.clip(-dot(rays.normals, rays.directions), 0.0, 1.0)
        power = (by_object(rays, acoustic_reflectivity) * cosine).reshape(shape).T * (64.0 / self.ray_number)
        cells = np.where(hit >= 0, rays.ranges.reshape(shape).T / self.max_range * self.samples, self.samples)
        bins = np.minimum(cells.astype(np.int64), self.samples)
        power = echoes_by_range(bins, power, (hit[:-1] == hit[1:]) & (hit[:-1] >= 0), self.samples)
        if self.errors:
            power = power * self.tick_random("speckle").standard_exponential(power.shape)
        amplitude = np.minimum(np.sqrt(power) * (32.0 * 10.0 ** (self.gain / 20.0)), 255.0).astype(np.uint8)
        row = np.concatenate([amplitude[::-1, 0], amplitude[:, 1]])
        image = np.asarray(self.local_data["image"])
        before = image if image.ndim == 2 and image.shape[1] == len(row) else np.zeros((0, len(row)), np.uint8)
        self.local_data["image"] = np.concatenate([before[max(0, len(before) + 1 - self.pings) :], row[None]])

    def noisy_fields(self) -> tuple[str, ...]:
        """Return no fields, because ``errors`` determines the noise."""
        return ()

    def shown(self) -> dict[str, object]:
        """The image, the newest ping on top."""
        image = np.asarray(self.local_data["image"])[::-1]
        if not image.size:
            return {}
        return picture((image[..., None] * np.array([1.0, 0.75, 0.35])).astype(np.uint8), self.local_data)
