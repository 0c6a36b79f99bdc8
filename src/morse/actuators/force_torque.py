"""Force and torque on a robot at the position of the actuator."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.core.actuator import Actuator
from morse.core.limits import FORCE, TORQUE
from morse.helpers.components import add_data, add_kind, add_property

if TYPE_CHECKING:
    from collections.abc import Mapping


class ForceTorque(Actuator):
    """Applies a force and a torque to the robot.

    Force and torque are given along the axes of the actuator. The force acts at the position of the actuator, so that
    it also causes a torque about the origin of the robot. With ``RobotFrame`` they are given along the axes of the
    robot, and act at its origin. As in MORSE 1.4, a force at the origin of the robot is applied at its centre of mass.
    """

    applies_forces = True
    _name = "Force/Torque Motion Controller"
    _short_desc = "Motion controller using force and torque to move a robot"

    add_data("force", [0.0, 0.0, 0.0], "vec3<float>", "Along X, Y and Z", frame="own", shape=3, **FORCE)
    add_data("torque", [0.0, 0.0, 0.0], "vec3<float>", "About X, Y and Z", frame="own", shape=3, **TORQUE)
    add_property("_robot_frame", False, "RobotFrame", "bool", "Use the axes of the robot, not of the actuator")
    add_kind("wrench", force="force", torque="torque")

    _robot_frame: bool

    @property
    def field_changes(self) -> Mapping[str, Mapping[str, object]]:
        """Return the frame of the fields, which depends on the property."""
        return {"force": {"frame": "robot"}, "torque": {"frame": "robot"}} if self._robot_frame else {}

    def default_action(self) -> None:
        """Apply the force and the torque."""
        force, torque = self.local_data["force"], self.local_data["torque"]
        if not any(force) and not any(torque):
            return
        body = self.robot_parent.bge_object
        if self._robot_frame:
            body.wrench(force, torque, True)
            return
        (x, y, z), r = self.bge_object.world_pose()
        bx, by, bz = body.world_pose()[0]
        x, y, z = x - bx, y - by, z - bz
        fx, fy, fz = (r[i] * force[0] + r[i + 1] * force[1] + r[i + 2] * force[2] for i in (0, 3, 6))
        tx, ty, tz = (r[i] * torque[0] + r[i + 1] * torque[1] + r[i + 2] * torque[2] for i in (0, 3, 6))
        body.wrench((fx, fy, fz), (tx + y * fz - z * fy, ty + z * fx - x * fz, tz + x * fy - y * fx), False)
