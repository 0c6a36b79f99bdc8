"""Messages of clients, written into the data of a component; refused messages are logged."""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING

from morse.core.clients.complaints import Complaints
from morse.core.reports.quoting import shown
from morse.core.validation.commands import Commands
from morse.core.validation.errors import CommandError

if TYPE_CHECKING:
    from collections.abc import Callable

    from morse.core.clients.arrivals import Sender
    from morse.core.interfaces import Component
    from morse.core.values import Value

#: number of letters of a message in the log
_SHOWN = 80
#: number of fields of clients that are known to be refused at present
_MOST_REFUSED = 256


class ClientCommands:
    """The commands of the clients of a stream.

    Args:
        component: their target.
        logger: of the middleware.
        what: what the middleware calls a message.

    Attributes:
        complaints: the log of refused messages.
    """

    def __init__(self, component: Component, logger: logging.Logger, what: str = "message") -> None:
        self._component, self._logger, self._what = component, logger, what
        self._commands = Commands(component)
        self.complaints = Complaints(logger)
        self._sender: Sender = component.context.arrivals.sender()
        #: the clients and fields whose last value was refused
        self._refused: set[tuple[str, str]] = set()

    @property
    def rest(self) -> bool:
        """Whether messages have to wait, because earlier ones took more than their share of the time."""
        return self._sender.until is not None and self._sender.rests

    def take(self, decode: Callable[[Value], object], message: object) -> bool:
        """Write the fields of a message into the data of the component; whether that was possible.

        If the simulation is not paced by the wall clock, its clients wait for it, and messages never wait.

        Args:
            decode: returns the fields of the message, or None if it has none. It may be code of a user: an exception
                only refuses the message.
            message: as it has arrived; bytes may have the attribute ``client``, the address of their client.
        """
        if not self._component.context.paced():
            return self._take(decode, message)
        with self._sender.measured():
            command = self._take(decode, message)
        self._sender.rest_if_due()
        return command

    def _take(self, decode: Callable[[Value], object], message: object) -> bool:
        client = getattr(message, "client", "") if isinstance(message, bytes) else ""
        try:
            fields = decode(message)
        except CommandError as error:
            self._refuse_field(client, error)
            return False
        except Exception as error:
            text = shown(message[:_SHOWN] if isinstance(message, (bytes, str)) else message)
            self._refuse(client, "read", f"this {self._what} cannot be read ({type(error).__name__}: {error}): {text}")
            return False
        if fields is None:
            return False
        try:
            remark = self._commands.take(fields)
        except CommandError as error:
            self._refuse_field(client, error)
            return False
        if self._refused and isinstance(fields, dict):
            accepted = {
                "read",
                "field ",
                *(f"field {field}" for field in self._component.local_data if field in fields),
            }
            self._refused = {(one, kind) for one, kind in self._refused if one != client or kind not in accepted}
        if remark is not None:
            self._logger.warning("%s: %s", self._component.name(), remark)
        return True

    def _refuse_field(self, client: str, error: CommandError) -> None:
        self._refuse(client, f"field {error.field}", f"a {self._what} is refused: {error}")

    def complain(self, kind: str, text: str) -> None:
        """Log a problem of a client, at most once in a while for each kind."""
        self.complaints.warn(kind, f"{self._component.name()}: {text}")

    def _refuse(self, client: str, kind: str, text: str) -> None:
        """Log a refused message: at once if the last one of this client was accepted, else once in a while."""
        begins = (client, kind) not in self._refused
        if begins and len(self._refused) < _MOST_REFUSED:
            self._refused.add((client, kind))
        is_strict = self._component.context.strict
        level, prefix = (logging.ERROR, "[ERROR][MORSE] ") if is_strict else (logging.WARNING, "")
        self.complaints.log(level, kind, f"{prefix}{self._component.name()}: {text}", begins=begins)
