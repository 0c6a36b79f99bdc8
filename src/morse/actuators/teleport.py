"""Sets the pose of a robot immediately."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from morse.actuators.goal_motion import PoseHolding
from morse.core.limits import ANGLE, POSITION, Angle, Position
from morse.core.services import service
from morse.core.validation import Commands
from morse.helpers.components import add_data, add_kind, euler
from morse.mathutils.rotations import rotation_from_euler

if TYPE_CHECKING:
    from morse.core.robot import Robot
    from morse.core.world import Body


class Teleport(PoseHolding):
    """Sets the pose of the robot every tick, so that the robot stays there while the actuator is active.

    The robot is released when the actuator is deactivated (service ``simulation.deactivate``).
    """

    _name = "Teleport"
    _short_desc = "Motion controller which instantly changes the pose of the robot"

    add_data("x", 0.0, "float", "X; initially that of the robot", frame="world", **POSITION)
    add_data("y", 0.0, "float", "Y; initially that of the robot", frame="world", **POSITION)
    add_data("z", 0.0, "float", "Z; initially that of the robot", frame="world", **POSITION)
    add_data("yaw", 0.0, "float", "Rotation about Z; initially that of the robot", frame="world", **ANGLE)
    add_data("pitch", 0.0, "float", "Rotation about Y; initially that of the robot", frame="world", **ANGLE)
    add_data("roll", 0.0, "float", "Rotation about X; initially that of the robot", frame="world", **ANGLE)

    add_kind("pose", position=("x", "y", "z"), orientation=euler("roll", "pitch", "yaw"))

    def __init__(self, obj: Body, parent: Robot | None = None) -> None:
        super().__init__(obj, parent)
        pose = self.robot_parent.position_3d
        for field in ("x", "y", "z", "yaw", "pitch", "roll"):
            self.local_data[field] = float(getattr(pose, field))

    @service
    def translate(self, x: Position, y: Position = 0.0, z: Position = 0.0) -> None:
        """Translate the robot along the axes of the world.

        Args:
            x: metres.
            y: metres.
            z: metres.
        """
        self._shift(x=x, y=y, z=z)

    @service
    def rotate(self, roll: Angle, pitch: Angle = 0.0, yaw: Angle = 0.0) -> None:
        """Rotate the robot relative to its present orientation.

        Args:
            roll: radians about X.
            pitch: radians about Y.
            yaw: radians about Z.
        """
        self._shift(roll=roll, pitch=pitch, yaw=yaw)

    def _shift(self, **shifts: float) -> None:
        Commands(self).take({name: self.local_data[name] + shift for name, shift in shifts.items()})

    def default_action(self) -> None:
        """Set the pose of the robot, at rest."""
        data = self.local_data
        place, angles = (data["x"], data["y"], data["z"]), (data["roll"], data["pitch"], data["yaw"])
        if not all(map(math.isfinite, (*place, *angles))):
            return
        body = self.robot_parent.bge_object
        body.set_pose(place, rotation_from_euler(angles, "XYZ"))
        body.halt()
        body.suspendDynamics()
