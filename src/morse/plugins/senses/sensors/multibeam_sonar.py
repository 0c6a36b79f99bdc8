"""A multibeam echo sounder."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from morse.core.declarations import BuilderDefaults, Visual
from morse.helpers.components import add_data, add_kind, add_property
from morse.plugins.senses.scanning import ScanningSensor, in_world, steps
from morse.plugins.senses.water import chord, sound_speed

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]


def _found(sonar: MultibeamSonar) -> Floats:
    points = np.asarray(sonar.local_data["points"], dtype=np.float64)
    return np.asarray(points[np.isfinite(sonar.local_data["ranges"])])


class MultibeamSonar(ScanningSensor):
    """Measures the profile of the bottom across the track: a distance for each of many beams.

    If the speed of sound changes with the depth (``gradient``), rays are circles by Snell's law. A beam then reaches
    the bottom elsewhere, while the instrument computes the point from the time as if rays were straight: ``points`` and
    ``ranges`` have the error that a survey without a sound speed profile has. The arc is replaced by its chord.
    """

    _name = "Multibeam sonar"
    _short_desc = "Depth profile across the track"
    _source = "Mackenzie 1981; Urick, Principles of Underwater Sound, section 5.6"
    _builder = BuilderDefaults(frequency=10.0, visual=Visual("cube", (0.06, 0.12, 0.04), (0.1, 0.1, 0.1)))
    _products = (
        BuilderDefaults(
            "SonicR2024",
            frequency=20.0,
            visual=Visual("cube", (0.06, 0.14, 0.04), (0.1, 0.1, 0.1)),
            properties={"beams": 256, "fov": 160.0, "max_range": 400.0},
            doc="An R2Sonic 2024: 256 beams over up to 160 degrees, 400 m.",
            source="data sheet of the Sonic 2024 (R2Sonic)",
        ),
    )

    add_data(
        "ranges",
        [],
        "list<float>",
        "Distance by time and assumed speed, from port to starboard; infinite without an echo",
        unit="m",
        shape=(None,),
        dtype="float64",
        low=0.0,
        allow=("inf",),
    )
    add_data(
        "points",
        [],
        "list",
        "The point of each beam; [0, 0, 0] without an echo",
        unit="m",
        frame="own",
        shape=(None, 3),
        dtype="float64",
    )

    add_property("beams", 256, "beams", "integer", "Number of beams", low=2, high=1024)
    add_property("fov", 120.0, "fov", "float", "Full angle across the track", unit="deg", low=1.0, high=178.0)
    add_property("max_range", 100.0, "max_range", "float", "Largest distance", unit="m", low=0.5, high=1e4)
    add_property("temperature", 10.0, "temperature", "float", "Of the water", unit="°C", low=-2.0, high=40.0)
    add_property("salinity", 35.0, "salinity", "float", "Of the water, parts per thousand", low=0.0, high=45.0)
    add_property(
        "gradient", 0.0, "gradient", "float", "Of the speed of sound, downwards", unit="1/s", low=-5.0, high=5.0
    )
    add_property(
        "assumed_speed",
        0.0,
        "assumed_speed",
        "float",
        "Of the instrument; 0 for that at the sensor",
        unit="m/s",
        low=0.0,
        high=2e3,
    )

    add_kind("cloud", points=_found)

    shaping = ("beams", "fov", "max_range")
    beams: int
    fov: float
    max_range: float
    temperature: float
    salinity: float
    gradient: float
    assumed_speed: float

    def directions(self) -> Floats:
        """Return the beams from port to starboard."""
        angles = steps(math.radians(self.fov), self.beams)[::-1]
        return np.array([(0.0, math.sin(angle), -math.cos(angle)) for angle in angles])

    def reach(self) -> float:
        """Return the largest distance, m."""
        return self.max_range

    def ray_count(self) -> float:
        """Return the number of beams; with a gradient each is cast twice."""
        return 2.0 * self.beams

    def measure(self) -> None:
        """Measure the profile."""
        rays = self.scan()
        beams = self.directions()
        speed = sound_speed(self.temperature, self.salinity, max(-self.position_3d.z, 0.0))
        lengths = rays.distances
        if self.gradient:
            rays.turn_to(self._bent(beams, lengths, speed))
            rays.refresh()
            lengths = rays.distances
            rays.turn_to(beams)
        heights = -in_world(self, beams)[:, 2] * np.where(np.isfinite(lengths), lengths, 0.0)
        mean = np.maximum(speed + self.gradient * heights / 2.0, 1.0)
        ranges = lengths * (self.assumed_speed or speed) / mean
        data = self.local_data
        data["ranges"] = ranges
        data["points"] = beams * np.where(np.isfinite(ranges), ranges, 0.0)[:, None] + 0.0

    def _bent(self, beams: Floats, lengths: Floats, speed: float) -> Floats:
        """Return the directions (N, 3) from the sensor to the ends of bent rays of some lengths."""
        rows = []
        inverse = np.array(self.bge_object.worldOrientation, dtype=np.float64)
        for (x, y, z), length in zip(in_world(self, beams).tolist(), lengths.tolist(), strict=True):
            flat = math.hypot(x, y)
            angle = math.atan2(-z, flat)
            if math.isfinite(length) and flat > 0.0:
                angle = chord(angle, length, speed, self.gradient)
                x, y, z = x / flat * math.cos(angle), y / flat * math.cos(angle), -math.sin(angle)
            rows.append([sum(inverse[i][j] * part for i, part in enumerate((x, y, z))) for j in range(3)])
        return np.array(rows)
