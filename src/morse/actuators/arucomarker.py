"""A marker for cameras with a controllable pose."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from morse.core import mathutils
from morse.core.actuator import Actuator
from morse.core.classes.builder_defaults import BuilderDefaults
from morse.core.limits import ANGLE, POSITION
from morse.core.services import service
from morse.helpers.components import add_data, add_kind, add_property, add_state, euler

if TYPE_CHECKING:
    from morse.core.robot import Robot
    from morse.core.world import Body

_ALIKE = 1e-9


class Arucomarker(Actuator):
    """A marker that is placed at a pose given in camera axes: X right, Y down, Z forward.

    In world axes, its position is the position of the robot plus (z + xoffset, x + yoffset, -y + zoffset). The angles
    roll, pitch and yaw are rotations about X, Y and Z, in the order Y, Z, X.
    """

    _name = "ARUCO Marker"
    _short_desc = "A marker for cameras with a controllable pose"
    _builder = BuilderDefaults(model="arucomarker")

    add_data("x", 0.0, "float", "To the right", frame="none", **POSITION)
    add_data("y", 0.0, "float", "Down", frame="none", **POSITION)
    add_data("z", 0.0, "float", "Forward", frame="none", **POSITION)
    add_data("roll", 0.0, "float", "About X", frame="none", **ANGLE)
    add_data("pitch", 0.0, "float", "About Y", frame="none", **ANGLE)
    add_data("yaw", 0.0, "float", "About Z", frame="none", **ANGLE)
    add_kind("pose", position=("x", "y", "z"), orientation=euler("roll", "pitch", "yaw"))
    add_property("_x_offset", 0.0, "xoffset", "float", "Along X of the world", **POSITION)
    add_property("_y_offset", 0.0, "yoffset", "float", "Along Y of the world", **POSITION)
    add_property("_z_offset", 0.0, "zoffset", "float", "Along Z of the world", **POSITION)

    add_state("_rotation", tuple, "Rotation matrix of the last command, row-major")
    add_state("_turned", tuple | None, "Angles of the last command", unit="rad")

    _x_offset: float
    _y_offset: float
    _z_offset: float

    def __init__(self, obj: Body, parent: Robot | None = None) -> None:
        super().__init__(obj, parent)
        self._turned: tuple[float, float, float] | None = None

    def default_action(self) -> None:
        """Set the pose of the marker."""
        data = self.local_data
        x, y, z = self.robot_parent.bge_object.world_pose()[0]
        place = (x + data["z"] + self._x_offset, y + data["x"] + self._y_offset, z - data["y"] + self._z_offset)
        angles = (data["roll"], data["pitch"], data["yaw"])
        if self._turned != angles:
            rows = mathutils.Euler(angles, "YZX").to_matrix()
            self._rotation = tuple(float(number) for row in rows for number in row)
            self._turned = angles
        here, camera_rotation = self.bge_object.world_pose()
        if math.dist(here, place) > _ALIKE or math.dist(camera_rotation, self._rotation) > _ALIKE:
            self.bge_object.set_pose(place, self._rotation)

    @service(changes=False)
    def get_local_position(self) -> list[float]:
        """Return the position in the frame of its parent, m."""
        return list(map(float, self.bge_object.localPosition))

    @service(changes=False)
    def get_world_position(self) -> list[float]:
        """Return the position in the world, m."""
        return list(map(float, self.bge_object.worldPosition))

    @service(changes=False)
    def get_local_orientation(self) -> list[float]:
        """Return roll, pitch and yaw in the frame of its parent, rad."""
        return list(map(float, self.bge_object.localOrientation.to_euler()))

    @service(changes=False)
    def get_world_orientation(self) -> list[float]:
        """Roll, pitch and yaw in the world, rad."""
        return list(map(float, self.bge_object.worldOrientation.to_euler()))
