"""Height above what is below."""

from __future__ import annotations

from typing import Any

from morse.core.declarations import BuilderDefaults, Visual
from morse.core.sensor import Sensor
from morse.helpers.components import add_data, add_property


class RadarAltimeter(Sensor):
    """Measures the distance straight down, whatever the attitude of the robot, to the first thing below."""

    _name = "Radar Altimeter"
    _short_desc = "Compute the distance to the ground"
    _builder = BuilderDefaults(visual=Visual("cube", (0.02, 0.02, 0.02), (0.1, 0.8, 0.8)))

    add_data("z", 0.0, "float", "Distance to the ground; infinite if there is none within reach", unit="m")
    add_property("_max_range", 30.0, "MaxRange", "float", "How far it sees, m")

    _max_range: float

    def __init__(self, obj: Any, parent: Any = None) -> None:
        super().__init__(obj, parent)
        self._look_down()

    def _look_down(self) -> None:
        self._reach = self._max_range
        if not self._reach > 0.0:
            raise ValueError(f"MaxRange takes a number of metres greater than 0, got {self._reach!r}")
        self.add_rays([[0.0, 0.0, -1.0]], self._reach, upright=True)

    def default_action(self) -> None:
        """Take the height."""
        if self._max_range != self._reach:
            self._look_down()
        self.rays.refresh()
        self.local_data["z"] = float(self.rays.distances[0])
