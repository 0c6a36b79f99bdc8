"""Distance along a ray, or to the nearest object in a cone."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from morse.core.clients.budgets import RAY
from morse.core.declarations import BuilderDefaults, Visual
from morse.core.sensor import Sensor
from morse.helpers.components import add_data, add_kind, add_property, prop

if TYPE_CHECKING:
    from morse.core.robot import Robot
    from morse.core.world import Body


class RangeFinder(Sensor):
    """Measures the distance to the nearest object along its X axis, or in a cone around it.

    The cone is sampled by rays whose neighbours are at most ``resolution`` apart. Rays ignore the robot of the sensor.
    """

    _name = "Range finder"
    _short_desc = "Distance to the nearest object ahead, by infrared light or ultrasound"
    _builder = BuilderDefaults(
        frequency=20.0,
        visual=Visual("cylinder", (0.01, 0.01, 0.01), (0.1, 0.1, 0.1)),
        doc="A range finder with a single ray: 10 m, 20 Hz.",
    )
    _products = (
        BuilderDefaults(
            "UltrasonicRangeFinder",
            frequency=20.0,
            properties={"range": 4.0, "min_range": 0.02, "cone": 30.0, "radiation": "ultrasound"},
            visual=Visual("cylinder", (0.02, 0.02, 0.01), (0.7, 0.7, 0.7)),
            doc="An ultrasonic range finder: a cone of 30 degrees, 0.02 to 4 m, 20 Hz.",
        ),
    )

    add_data(
        "distance",
        math.inf,
        "float",
        "Distance to the nearest object; infinite beyond range, -infinite below min_range",
        unit="m",
        frame="own",
        low=0.0,
        allow=("inf", "-inf"),
    )
    add_property("_range", 10.0, "range", "float", "Largest distance", unit="m", low=1e-3, high=1e7)
    add_property("_min_range", 0.0, "min_range", "float", "Smallest distance", unit="m", low=0.0, high=1e7)
    add_property(
        "_cone", 0.0, "cone", "float", "Full angle of the cone; 0 for one ray", unit="deg", low=0.0, high=180.0
    )
    add_property(
        "_resolution", 3.0, "resolution", "float", "Angle between rays of a cone", unit="deg", low=0.5, high=90.0
    )
    add_property(
        "radiation",
        "infrared",
        "radiation",
        "string",
        "Kind of radiation",
        choices=("infrared", "ultrasound", "radar"),
    )
    add_property("on_demand", False, "on_demand", "bool", "Rays are only cast while somebody reads them")
    add_kind(
        "range",
        distance="distance",
        min=prop("_min_range"),
        max=prop("_range"),
        fov=prop("_cone"),
        radiation=prop("radiation"),
    )

    _range: float
    _min_range: float
    _cone: float
    _resolution: float
    radiation: str

    def __init__(self, obj: Body, parent: Robot | None = None) -> None:
        super().__init__(obj, parent)
        self._look_ahead()

    def sensing_cost(self) -> float:
        """Return the number of rays of the cone, in pixels: about its solid angle by the square of their distance."""
        half, step = math.radians(self._cone) / 2.0, math.radians(self._resolution)
        return RAY * (1.0 + 2.0 * math.pi * (1.0 - math.cos(half)) / step**2)

    def _shape(self) -> tuple[float, float, float]:
        return self._range, self._cone, self._resolution

    def _look_ahead(self) -> None:
        self._looks = self._shape()
        self.remove_request(self.rays)
        self.add_rays(cone_of_rays(self._cone, self._resolution), self._range)

    def measure(self) -> None:
        """Measure the distance."""
        if self._looks != self._shape():
            self._look_ahead()
        self.rays.refresh()
        distance = float(np.min(self.rays.distances))
        self.local_data["distance"] = -math.inf if distance < self._min_range else distance


def cone_of_rays(angle: float, resolution: float) -> list[tuple[float, float, float]]:
    """Return unit vectors in a cone around X: one along the axis, the others in rings, the last ring on the cone.

    Args:
        angle: full opening angle, degrees.
        resolution: largest angle between neighbours, degrees.
    """
    rays = [(1.0, 0.0, 0.0)]
    half, step = math.radians(angle) / 2.0, math.radians(resolution)
    rings = math.ceil(half / step - 1e-9)
    for ring in range(1, rings + 1):
        tilt = half * ring / rings
        count = max(3, math.ceil(2.0 * math.pi * math.sin(tilt) / step))
        for number in range(count):
            turned = 2.0 * math.pi * number / count
            rays.append((math.cos(tilt), math.sin(tilt) * math.cos(turned), math.sin(tilt) * math.sin(turned)))
    return rays
