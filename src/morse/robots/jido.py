"""Jido."""

from morse.core.classes.builder_defaults import RobotDefaults
from morse.core.robot import Robot


class Jido(Robot):
    """An indoor robot with a mast."""

    _name = "Jido"
    _builder = RobotDefaults("jido")
