"""Puts a robot where it is told, at once."""

import math
from typing import Any

from morse.core import mathutils
from morse.core.actuator import Actuator
from morse.core.services import service
from morse.helpers.components import add_data


class Teleport(Actuator):
    """Forces the pose of the robot every tick: the robot hovers there while this is active.

    Switched off (service ``simulation.deactivate``), it lets the robot go.
    """

    _name = "Teleport"
    _short_desc = "Motion controller which changes instantly the pose of the robot"

    add_data("x", 0.0, "float", "X in the world; at first that of the robot", unit="m")
    add_data("y", 0.0, "float", "Y in the world; at first that of the robot", unit="m")
    add_data("z", 0.0, "float", "Z in the world; at first that of the robot", unit="m")
    add_data("yaw", 0.0, "float", "Rotation about Z; at first that of the robot", unit="rad")
    add_data("pitch", 0.0, "float", "Rotation about Y; at first that of the robot", unit="rad")
    add_data("roll", 0.0, "float", "Rotation about X; at first that of the robot", unit="rad")

    def __init__(self, obj: Any, parent: Any = None) -> None:
        super().__init__(obj, parent)
        pose = self.robot_parent.position_3d
        for field in ("x", "y", "z", "yaw", "pitch", "roll"):
            self.local_data[field] = float(getattr(pose, field))

    @property
    def active(self) -> bool:
        """Whether it holds the robot."""
        return self._active

    @active.setter
    def active(self, value: bool) -> None:
        self._active = bool(value)
        if not self._active:
            self.robot_parent.bge_object.restoreDynamics()

    @service
    def translate(self, x: float, y: float = 0.0, z: float = 0.0) -> None:
        """Shift the robot, in the axes of the world.

        Args:
            x: metres.
            y: metres.
            z: metres.
        """
        self.local_data["x"] += x
        self.local_data["y"] += y
        self.local_data["z"] += z

    @service
    def rotate(self, roll: float, pitch: float = 0.0, yaw: float = 0.0) -> None:
        """Turn the robot further.

        Args:
            roll: radians about X.
            pitch: radians about Y.
            yaw: radians about Z.
        """
        self.local_data["roll"] += roll
        self.local_data["pitch"] += pitch
        self.local_data["yaw"] += yaw

    def default_action(self) -> None:
        """Put the robot to its pose, at rest."""
        data = self.local_data
        if not all(map(math.isfinite, (data[f] for f in ("x", "y", "z", "yaw", "pitch", "roll")))):
            return
        orientation = mathutils.Euler([data["roll"], data["pitch"], data["yaw"]])
        self.robot_parent.force_pose([data["x"], data["y"], data["z"]], orientation)
        self.robot_parent.bge_object.suspendDynamics()
