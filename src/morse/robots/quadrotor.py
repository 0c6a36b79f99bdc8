"""Quadrotor."""

from morse.core.classes.builder_defaults import RobotDefaults
from morse.core.robot import Robot


class Quadrotor(Robot):
    """A quadrotor with a rigid body."""

    _name = "Quadrotor"
    _builder = RobotDefaults("quadrotor_dynamic", drive="free")
