"""The base class of actuators."""

from __future__ import annotations

from copy import deepcopy
from typing import TYPE_CHECKING, ClassVar

from morse.core.guard import modify, read
from morse.core.journal import COMMAND
from morse.core.object import Object

if TYPE_CHECKING:
    from collections.abc import Sequence


class Actuator(Object):
    """Does something with the data it receives: read ``local_data`` in ``default_action``.

    The last command stays in ``local_data`` and is applied again every tick.

    Attributes:
        obeys_controls: whether it reads the keys or the gamepad of the live view.
    """

    obeys_controls: ClassVar[bool] = False

    def action(self) -> None:
        """One tick: update the pose, read the streams, apply the modifiers to new commands, call `default_action`."""
        if not self._active:
            return
        self.position_3d.update(self.bge_object)
        if self.input_functions:
            self.take_input()
            if not self._active:  # a modifier has failed
                return
        self.default_action()

    def take_input(self) -> None:
        """Read the commands that have arrived, and apply the modifiers to them."""
        if read(self, self.input_functions):
            if self.context.journal.sinks:
                self.context.journal.note(COMMAND, self.name(), deepcopy(dict(self.local_data)))
            modify(self, self.input_modifiers)

    def apply_speed(self, kind: str, linear_speed: Sequence[float], angular_speed: Sequence[float]) -> None:
        """Drive the robot during this tick; see `morse.core.robot.Robot.apply_speed`."""
        assert self.robot_parent is not None
        self.robot_parent.apply_speed(kind, linear_speed, angular_speed)
