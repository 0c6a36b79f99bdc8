"""Data of actuators that the page sets: processed like the streams of clients."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.core.actuator import Actuator
from morse.core.streams.pending_commands import PendingCommands

if TYPE_CHECKING:
    from morse.core.context import Context
    from morse.core.values import JsonObject


class Commands:
    """Passes values of the driving page to actuators at their next action."""

    def __init__(self, context: Context) -> None:
        self._context = context
        self._pending: dict[str, PendingCommands] = {}

    def restarted(self) -> None:
        """The components were created again."""
        self._pending.clear()

    def set(self, name: str, fields: JsonObject) -> None:
        """Set fields of an actuator.

        Raises:
            ValueError: there is no such actuator, it has no such field, or a value is invalid.
        """
        component = self._context.components.get(name)
        if not isinstance(component, Actuator):
            raise ValueError(f"there is no actuator '{name}'")
        if name not in self._pending:
            self._pending[name] = PendingCommands(component)
        self._pending[name].give(fields)
