"""The data of actuators, set on the page: taken in as the streams of clients are."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from morse.core.actuator import Actuator
from morse.core.pending_commands import PendingCommands

if TYPE_CHECKING:
    from morse.core.context import Context


class Commands:
    """Gives actuators what the driving page sets, when they next act."""

    def __init__(self, context: Context) -> None:
        self._context = context
        self._pending: dict[str, PendingCommands] = {}

    def restarted(self) -> None:
        """The components are new ones."""
        self._pending.clear()

    def set(self, name: str, fields: dict[str, Any]) -> None:
        """Set fields of an actuator.

        Raises:
            ValueError: there is no such actuator, it has no such field, or a value does not fit.
        """
        component = self._context.components.get(name)
        if not isinstance(component, Actuator):
            raise ValueError(f"there is no actuator '{name}'")
        if name not in self._pending:
            self._pending[name] = PendingCommands(component)
        self._pending[name].give(fields)
