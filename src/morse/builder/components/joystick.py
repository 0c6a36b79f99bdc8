"""Gamepads."""

from __future__ import annotations

from morse.builder.creator import ActuatorCreator
from morse.builder.errors import checks


class Joystick(ActuatorCreator):
    """A gamepad at the live view; its component class is `morse.actuators.joystick.Joystick`."""

    _classpath = "morse.actuators.joystick.Joystick"

    def __init__(self, name: str | None = None, index: int = 0) -> None:
        """Create a joystick.

        Args:
            index: pair of axes of the gamepad: 0 for the first stick.
        """
        super().__init__(name)
        self.properties(Index=checks.integer(index, "Joystick(index)", minimum=0))
