"""Morsy."""

from morse.core.classes.builder_defaults import RobotDefaults
from morse.core.robot import Robot


class Morsy(Robot):
    """The mascot of MORSE, a small rigid robot to drive around."""

    _name = "Morsy"
    _builder = RobotDefaults("morsy")
