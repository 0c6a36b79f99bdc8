"""Velocity of the robot."""

from morse.core.declarations import BuilderDefaults, Visual
from morse.core.rows.marks import on_read
from morse.helpers.components import add_data, add_kind
from morse.sensors.motion_sensor import MotionSensor, velocities_at

_ZERO = [0.0, 0.0, 0.0]


class Velocity(MotionSensor):
    """Measures linear and angular velocity.

    If the velocity of the body is used, it is the velocity of the origin of the robot, independent of the position of
    the sensor.
    """

    _name = "Velocity"
    _short_desc = "A sensor returning the linear and angular velocity of the robot, in the axes of the sensor"
    _builder = BuilderDefaults(visual=Visual("sphere", (0.04, 0.04, 0.02), (0.2, 0.8, 0.1)))

    add_data("linear_velocity", _ZERO, "vec3<float>", "Velocity", unit="m/s", frame="own", shape=3)
    add_data("angular_velocity", _ZERO, "vec3<float>", "Angular velocity", unit="rad/s", frame="own", shape=3)
    add_data("world_linear_velocity", _ZERO, "vec3<float>", "Velocity", unit="m/s", frame="world", shape=3)
    velocity_fields = frozenset(("linear_velocity", "angular_velocity", "world_linear_velocity"))
    add_kind("twist", linear="linear_velocity", angular="angular_velocity")

    @on_read
    def measure(self) -> None:
        """Measure the velocities."""
        motion = self.motion()
        rotation = self.position_3d.get_pose()[1]
        velocities = velocities_at(rotation, motion.linear, motion.angular)
        self.local_data.update((name, list(value)) for name, value in velocities.items())
