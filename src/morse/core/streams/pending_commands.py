"""Commands that are validated when they are given, and applied when the actuator acts."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.core.validation.commands import Commands

if TYPE_CHECKING:
    from morse.core.actuator import Actuator
    from morse.core.interfaces import Component
    from morse.core.values import Fields


class PendingCommands:
    """Passes commands from the process or the live view to an actuator, like a stream of a client.

    Commands for an inactive actuator are kept until it is active.
    """

    def __init__(self, actuator: Actuator) -> None:
        self._commands = Commands(actuator)
        self._waiting: Fields = {}
        actuator.input_functions.append(self._take)

    def move_to(self, actuator: Actuator) -> None:
        """Switch to an actuator that replaces the present one and has taken over its input functions."""
        self._commands = Commands(actuator)

    def fitting(self, message: object) -> Fields:
        """Return the fields of a message in the form that `put` takes.

        Raises:
            CommandError: the message is not a dictionary, a value is not valid, or the actuator has no such field.
        """
        return self._commands.fitting(message)

    def put(self, fields: Fields) -> None:
        """Set fields that `fitting` has returned, as `give` does."""
        self._waiting.update(fields)

    def give(self, message: object) -> None:
        """Set fields of the actuator at its next action; if a field is set several times, the last value is used.

        Raises:
            CommandError: the message is not a dictionary, a value is not valid, or the actuator has no such field; then
                no field is set.
        """
        self.put(self.fitting(message))

    @property
    def waiting(self) -> Fields:
        """Return the fields that have not been applied yet; always the same object, because groups rely on it."""
        return self._waiting

    def forget(self) -> None:
        """Discard the commands that have not been applied yet."""
        self._waiting.clear()

    @staticmethod
    def all_of(actuator: Component) -> list[PendingCommands]:
        """Return the instances of this class among the input functions of an actuator, in order."""
        owners = [getattr(function, "__self__", None) for function in actuator.input_functions]
        return [owner for owner in owners if isinstance(owner, PendingCommands)]

    def _take(self, actuator: Component) -> bool:
        if not self._waiting:
            return False
        actuator.local_data.update(self._waiting)
        self._waiting.clear()
        return True
