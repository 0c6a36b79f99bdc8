"""The connection to a MOOS database, which may be temporarily unavailable."""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING

from morse.core.clients.complaints import Complaints
from morse.core.exceptions import MorseMiddlewareError
from morse.system.extras import install

if TYPE_CHECKING:
    from morse.core.values import Options

logger = logging.getLogger(__name__)


class Database:
    """Sends and receives in its own thread; no call waits for the database.

    Args:
        options: see `morse.plugins.moos.MANAGER_OPTIONS`.

    Raises:
        MorseMiddlewareError: pymoos2 is not installed.
    """

    def __init__(self, options: Options) -> None:
        try:
            import pymoos2.core.MOOSMsg  # noqa: F401 - the import of `Exchange` must not fail
        except ImportError:
            raise MorseMiddlewareError(f"moos: pymoos2 is not installed; to install it: {install('moos')}") from None
        from morse.plugins.moos.exchange import Exchange

        self._host, self._port = options["moos_host"], options["moos_port"]
        self._complaints = Complaints(logger)
        self._was_connected = False
        self._exchange = Exchange(self._host, self._port, options["moos_name"], options["rate"])

    @property
    def place(self) -> str:
        """Address of the database."""
        return f"{self._host}:{self._port}"

    @property
    def connected(self) -> bool:
        """Whether the database is connected."""
        return self._exchange.is_connected

    @property
    def connections(self) -> int:
        """Number of connections so far."""
        return self._exchange.connections

    def register(self, variable: str) -> None:
        """Receive a variable from now on, also after a new connection."""
        self._exchange.register(variable)

    def unregister(self, variable: str) -> None:
        """Receive a variable no longer."""
        self._exchange.unregister(variable)

    def publish(self, variable: str, value: float | str) -> None:
        """Queue a variable; it is dropped if the database is not connected or too slow."""
        if self.connected and not self._exchange.notify(variable, value):
            self._complaints.warn("slow", f"moos: the database {self.place} is too slow: messages are lost")

    def received(self) -> list[tuple[str, float | str]]:
        """Return the variables that have arrived since the last call; log whether there is a database."""
        is_open, refusal = self.connected, self._exchange.refusal
        self._exchange.refusal = ""
        if is_open and not self._was_connected:
            self._complaints.log(logging.INFO, "connected", f"moos: connected to the database {self.place}")
        elif self._was_connected and not is_open:
            because = f": {refusal}" if refusal else ""
            self._complaints.warn("gone", f"moos: the database {self.place} has disconnected{because}")
        elif refusal:
            self._complaints.warn("refused", f"moos: the database {self.place} is not used: {refusal}")
        self._was_connected = is_open
        return [
            (message.key, message.val if message.is_double() else message.sval) for message in self._exchange.fetch()
        ]

    def close(self) -> None:
        """Disconnect."""
        self._exchange.close()
