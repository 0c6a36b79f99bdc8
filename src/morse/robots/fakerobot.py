"""Fake robot."""

from morse.core.classes.builder_defaults import RobotDefaults
from morse.core.robot import Robot


class FakeRobot(Robot):
    """A frame without a body that only carries components."""

    _name = "Fake robot"
    _builder = RobotDefaults(drive="free", collides=False)
