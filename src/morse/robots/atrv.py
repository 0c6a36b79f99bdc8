"""ATRV."""

from morse.core.classes.builder_defaults import RobotDefaults
from morse.core.robot import Robot


class ATRV(Robot):
    """A four-wheeled outdoor robot, driven as one rigid body."""

    _name = "ATRV"
    _builder = RobotDefaults("atrv")
