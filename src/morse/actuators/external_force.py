"""External forces on a robot, such as wind."""

from morse.core.actuator import Actuator
from morse.core.limits import FORCE, TORQUE
from morse.helpers.components import add_data, add_kind


class ExternalForce(Actuator):
    """Applies a force and a torque, along the axes of the world, to the centre of mass of the robot."""

    applies_forces = True
    _name = "External Force"
    _short_desc = "Applies forces of the surroundings, such as wind, to the robot"

    add_data("force", [0.0, 0.0, 0.0], "vec3<float>", "Along X, Y and Z", frame="world", shape=3, **FORCE)
    add_data("torque", [0.0, 0.0, 0.0], "vec3<float>", "About X, Y and Z", frame="world", shape=3, **TORQUE)
    add_kind("wrench", force="force", torque="torque")

    def default_action(self) -> None:
        """Apply the force and the torque."""
        force, torque = self.local_data["force"], self.local_data["torque"]
        if any(force) or any(torque):
            self.robot_parent.bge_object.wrench(force, torque, False)
