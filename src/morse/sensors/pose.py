"""Pose of the sensor."""

from __future__ import annotations

from morse.core.declarations import BuilderDefaults, Visual
from morse.core.rows.columns import POSES, in_columns
from morse.core.sensor import Sensor
from morse.helpers.components import add_data, add_kind, euler, on_read


class Pose(Sensor):
    """Measures the pose of the sensor in the world."""

    _name = "Pose"
    _short_desc = "A sensor which returns the full pose (translation + rotation) of the sensor in the world"
    _builder = BuilderDefaults(visual=Visual("cube", (0.04, 0.04, 0.02), (0.8, 0.1, 0.1)))

    add_data("x", 0.0, "float", "X in the world", unit="m", frame="world")
    add_data("y", 0.0, "float", "Y in the world", unit="m", frame="world")
    add_data("z", 0.0, "float", "Z in the world", unit="m", frame="world")
    add_data("yaw", 0.0, "float", "Rotation about Z", unit="rad", frame="world", angle=True)
    add_data("pitch", 0.0, "float", "Rotation about Y", unit="rad", frame="world", angle=True)
    add_data("roll", 0.0, "float", "Rotation about X", unit="rad", frame="world", angle=True)
    add_kind("pose", position=("x", "y", "z"), orientation=euler("roll", "pitch", "yaw"))

    @on_read
    @in_columns(POSES)
    def default_action(self) -> None:
        """Measure the pose."""
        data = self.local_data
        data["x"], data["y"], data["z"], data["yaw"], data["pitch"], data["roll"] = self.position_3d.numbers()
