"""Hummer."""

from morse.core.classes.builder_defaults import RobotDefaults
from morse.core.robot import Robot


class Hummer(Robot):
    """An off-road vehicle with steered wheels."""

    _name = "Hummer"
    _builder = RobotDefaults("hummer", properties={"RollingFriction": 0.055})
