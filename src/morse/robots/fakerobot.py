"""A frame without a body, that only carries components."""

from morse.core.robot import Robot


class FakeRobot(Robot):
    """A frame without a body, that only carries components."""

    _name = "Fake robot"
    _short_desc = "A frame without a body, that only carries components."
