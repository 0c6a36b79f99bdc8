"""B21."""

from morse.core.classes.builder_defaults import RobotDefaults
from morse.core.robot import Robot


class B21(Robot):
    """A round indoor robot."""

    _name = "B21"
    _builder = RobotDefaults("b21")
