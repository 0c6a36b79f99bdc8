"""Yaw, pitch and roll of the sensor."""

from morse.core.declarations import BuilderDefaults, Visual
from morse.core.sensor import Sensor
from morse.helpers.components import add_data, add_kind, euler


class Gyroscope(Sensor):
    """Measures the absolute yaw, pitch and roll of the sensor.

    `IMU` and `Attitude` measure angular velocities.
    """

    _name = "Gyroscope"
    _short_desc = "A sensor returning the absolute yaw, pitch and roll of the sensor"
    _builder = BuilderDefaults(visual=Visual("sphere", (0.04, 0.04, 0.02), (0.8, 0.4, 0.1)))

    add_data("yaw", 0.0, "float", "Rotation about Z", unit="rad", frame="world", angle=True)
    add_data("pitch", 0.0, "float", "Rotation about Y", unit="rad", frame="world", angle=True)
    add_data("roll", 0.0, "float", "Rotation about X", unit="rad", frame="world", angle=True)
    add_kind("attitude", orientation=euler("roll", "pitch", "yaw"))

    def measure(self) -> None:
        """Measure the angles."""
        data = self.local_data
        _, _, _, data["yaw"], data["pitch"], data["roll"] = self.position_3d.numbers()
