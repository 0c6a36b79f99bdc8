"""A four-wheeled outdoor robot, driven as one rigid body."""

from morse.core.robot import Robot


class ATRV(Robot):
    """A four-wheeled outdoor robot, driven as one rigid body."""

    _name = "ATRV"
    _short_desc = "A four-wheeled outdoor robot, driven as one rigid body."
