"""The connection to a MOOS database, which may be temporarily unavailable."""

from __future__ import annotations

import contextlib
import logging
import socket
import struct
from typing import TYPE_CHECKING, Any

from morse.core.complaints import Complaints
from morse.core.exceptions import MorseMiddlewareError
from morse.middleware.moos.mapping import INSTALL

if TYPE_CHECKING:
    from collections.abc import Mapping

logger = logging.getLogger(__name__)

#: largest packet that is read, bytes, and number of messages that wait to be sent or read
_LARGEST, _MOST_MESSAGES = 16 << 20, 20_000
#: bytes of the header of a packet
_HEADER = 9
#: wall-clock seconds in which the database must answer
_TIMEOUT = 5.0


class Database:
    """Sends and receives in its own thread; no call waits for the database.

    Args:
        options: see `morse.middleware.moos.mapping.MANAGER_OPTIONS`.

    Raises:
        MorseMiddlewareError: pymoos2 is not installed.
    """

    def __init__(self, options: Mapping[str, Any]) -> None:
        try:
            from pymoos2.core.MOOSCommClient import MOOSCommClient
            from pymoos2.core.MOOSCommPkt import unpack
        except ImportError:
            raise MorseMiddlewareError(f"moos: pymoos2 is not installed; to install it: {INSTALL}") from None
        self._host, self._port = options["moos_host"], options["moos_port"]
        self._complaints = Complaints(logger)
        self._was_connected = False
        client: Any = _made(MOOSCommClient, unpack)
        self._client = client(self._host, self._port, options["moos_name"], options["rate"])
        self._client.start()

    @property
    def place(self) -> str:
        """Address of the database."""
        return f"{self._host}:{self._port}"

    @property
    def connected(self) -> bool:
        """Whether the database is connected."""
        return bool(self._client.is_connected)

    def register(self, variable: str) -> None:
        """Receive a variable from now on, also after a new connection."""
        self._client.register(variable)

    def unregister(self, variable: str) -> None:
        """Receive a variable no longer."""
        self._client.unregister(variable)

    def publish(self, variable: str, value: float | str) -> None:
        """Queue a variable; it is dropped if the database is not connected or too slow."""
        if not self.connected:
            return
        if len(self._client._outbox) >= _MOST_MESSAGES:
            self._complaints.warn("slow", f"moos: the database {self.place} is too slow: messages are lost")
            return
        self._client.notify(variable, value)

    def received(self) -> list[tuple[str, float | str]]:
        """Return the variables that have arrived since the last call; log whether there is a database."""
        if self.connected != self._was_connected:
            self._was_connected = self.connected
            if self._was_connected:
                logger.info("moos: connected to the database %s", self.place)
            else:
                self._complaints.warn("gone", f"moos: the database {self.place} has disconnected")
        if self._client.refusal:
            refusal, self._client.refusal = self._client.refusal, ""
            self._complaints.warn("refused", f"moos: the database {self.place} is not used: {refusal}")
        return [(message.key, message.val if message.is_double() else message.sval) for message in self._client.fetch()]

    def close(self) -> None:
        """Disconnect."""
        self._client.stop()


def _made(base: Any, unpack: Any) -> Any:
    """The client of pymoos2, which survives whatever a database sends."""

    class Client(base):  # type: ignore[misc]
        #: why the last connection ended, for the log
        refusal = ""

        def _connect(self) -> None:
            try:
                super()._connect()
                self._sock.settimeout(_TIMEOUT)
            except (OSError, AttributeError) as error:
                self.refusal = str(error) or type(error).__name__
                raise ConnectionError(self.refusal) from None

        def _send_raw(self, data: bytes) -> None:
            connection = self._sock
            if connection is None:
                raise ConnectionError("closed")
            connection.sendall(data)

        def _recv_raw(self, count: int) -> bytes:
            data, connection = bytearray(), self._sock
            while len(data) < count:
                part = connection.recv(count - len(data)) if connection is not None else b""
                if not part:
                    raise ConnectionError("the database has closed the connection")
                data += part
            return bytes(data)

        def _recv_pkt(self) -> Any:
            header = self._recv_raw(4)
            (size,) = struct.unpack("<i", header)
            if not _HEADER <= size <= _LARGEST:
                self.refusal = f"a packet of {size} bytes"
                raise ConnectionError(self.refusal)
            try:
                messages = unpack(header + self._recv_raw(size - 4))
            except (struct.error, ValueError, LookupError) as error:
                self.refusal = f"a packet cannot be read ({error})"
                raise ConnectionError(self.refusal) from None
            if len(self._inbox) + len(messages) > _MOST_MESSAGES:
                self.refusal = "it sends more messages than are read"
                raise ConnectionError(self.refusal)
            return messages

        def _close(self) -> None:
            connection = self._sock
            if connection is not None:
                with contextlib.suppress(OSError):  # ends a pending receive
                    connection.shutdown(socket.SHUT_RDWR)
            super()._close()

    return Client
