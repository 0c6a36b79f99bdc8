"""Quadrotor 2012."""

from morse.core.classes.builder_defaults import RobotDefaults
from morse.core.robot import Robot


class QUAD2012(Robot):
    """A quadrotor without collision."""

    _name = "Quadrotor 2012"
    _builder = RobotDefaults("quadrotor", drive="free")
