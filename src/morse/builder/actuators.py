"""The actuators of MORSE, for scene scripts: one class for each component of `morse.actuators`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from morse.builder import checks, creator
from morse.builder.creator import ActuatorCreator

_derived = creator.derived_classes("morse.actuators", ActuatorCreator, __name__)
globals().update(_derived)


class Joystick(ActuatorCreator):
    """A gamepad at the live view; `morse.actuators.joystick.Joystick` runs."""

    _classpath = "morse.actuators.joystick.Joystick"

    def __init__(self, name: str | None = None, index: int = 0) -> None:
        """Make a joystick.

        Args:
            index: which pair of axes of the gamepad drives: 0 for the first stick.
        """
        super().__init__(name)
        self.properties(Index=checks.integer(index, "Joystick(index)", minimum=0))


__all__ = ["ActuatorCreator", "Joystick", *_derived]

if TYPE_CHECKING:

    def __getattr__(name: str) -> Any: ...
