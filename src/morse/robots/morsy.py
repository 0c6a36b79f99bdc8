"""The mascot of MORSE, a small rigid robot to drive around."""

from morse.core.robot import Robot


class Morsy(Robot):
    """The mascot of MORSE, a small rigid robot to drive around."""

    _name = "Morsy"
    _short_desc = "The mascot of MORSE, a small rigid robot to drive around."
