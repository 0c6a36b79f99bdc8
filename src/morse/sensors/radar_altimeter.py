"""Height above the ground."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.core.declarations import BuilderDefaults, Visual
from morse.core.sensor import Sensor
from morse.helpers.components import add_data, add_kind, add_property, prop

if TYPE_CHECKING:
    from morse.core.robot import Robot
    from morse.core.world import Body


class RadarAltimeter(Sensor):
    """Measures the vertical distance to the first object below, independent of the attitude of the robot."""

    _name = "Radar Altimeter"
    _short_desc = "Compute the distance to the ground"
    _builder = BuilderDefaults(visual=Visual("cube", (0.02, 0.02, 0.02), (0.1, 0.8, 0.8)))

    add_data(
        "z",
        0.0,
        "float",
        "Distance to the ground; infinite beyond the range",
        unit="m",
        frame="none",
        low=0.0,
        allow=("inf",),
    )
    add_property("_max_range", 30.0, "MaxRange", "float", "Largest distance", unit="m", low=1e-3, allow=("inf",))
    add_kind("range", distance="z", min=0.0, max=prop("_max_range"), fov=0.0, radiation="radar")

    _max_range: float

    def __init__(self, obj: Body, parent: Robot | None = None) -> None:
        super().__init__(obj, parent)
        self._look_down()

    def _look_down(self) -> None:
        self._reach = self._max_range
        self.remove_request(self.rays)
        self.add_rays([[0.0, 0.0, -1.0]], self._reach, upright=True)

    def measure(self) -> None:
        """Measure the height."""
        if self._max_range != self._reach:
            self._look_down()
        self.rays.refresh()
        self.local_data["z"] = float(self.rays.distances[0])
