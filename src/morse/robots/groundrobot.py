"""A generic ground robot."""

from morse.core.robot import Robot


class GroundRobot(Robot):
    """A robot that stays on the ground."""

    _name = "Ground robot"
    _short_desc = "A robot described by its model alone."
