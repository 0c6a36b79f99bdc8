"""Where the sensor is."""

from morse.core.declarations import BuilderDefaults, Visual
from morse.core.sensor import Sensor
from morse.helpers.components import add_data


class Pose(Sensor):
    """Measures the pose of the sensor in the world."""

    _name = "Pose"
    _short_desc = "A sensor which returns the full pose (translation + rotation) of the sensor in the world"
    _builder = BuilderDefaults(visual=Visual("cube", (0.04, 0.04, 0.02), (0.8, 0.1, 0.1)))

    add_data("x", 0.0, "float", "X in the world", unit="m")
    add_data("y", 0.0, "float", "Y in the world", unit="m")
    add_data("z", 0.0, "float", "Z in the world", unit="m")
    add_data("yaw", 0.0, "float", "Rotation about Z", unit="rad")
    add_data("pitch", 0.0, "float", "Rotation about Y", unit="rad")
    add_data("roll", 0.0, "float", "Rotation about X", unit="rad")

    def default_action(self) -> None:
        """Take the pose."""
        data = self.local_data
        data["x"], data["y"], data["z"], data["yaw"], data["pitch"], data["roll"] = self.position_3d.numbers()
