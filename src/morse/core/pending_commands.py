"""Commands that are checked when they are given, and taken when the actuator acts."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from morse.core.validation.commands import Commands

if TYPE_CHECKING:
    from morse.core.actuator import Actuator


class PendingCommands:
    """Gives an actuator fields from within the process or from the live view, as a stream of a client does.

    An actuator that is not active leaves them waiting.
    """

    def __init__(self, actuator: Actuator) -> None:
        self._commands = Commands(actuator)
        self._waiting: dict[str, Any] = {}
        actuator.input_functions.append(self._take)

    def move_to(self, actuator: Actuator) -> None:
        """Another actuator has come in the place of the present one, and has its input functions."""
        self._commands = Commands(actuator)

    def give(self, message: Any) -> None:
        """Let the actuator take some of its fields when it acts next; of several values of a field the last one wins.

        Raises:
            CommandError: the message is not a dictionary, a value does not fit, or the actuator has no such field; then
                nothing is taken.
        """
        self._waiting.update(self._commands.fitting(message))

    @property
    def waiting(self) -> dict[str, Any]:
        """The fields that the actuator has not taken yet."""
        return dict(self._waiting)

    def forget(self) -> None:
        """The actuator is not to take what it has not taken yet."""
        self._waiting = {}

    @staticmethod
    def all_of(actuator: Any) -> list[PendingCommands]:
        """Those that an actuator takes commands from, in its order."""
        owners = [getattr(function, "__self__", None) for function in actuator.input_functions]
        return [owner for owner in owners if isinstance(owner, PendingCommands)]

    def _take(self, actuator: Any) -> bool:
        if not self._waiting:
            return False
        waiting, self._waiting = self._waiting, {}
        actuator.local_data.update(waiting)
        return True
