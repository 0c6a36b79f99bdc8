"""The connection to a MOOS database, which may be temporarily unavailable."""

from __future__ import annotations

import contextlib
import logging
import socket
import struct
import time
from typing import TYPE_CHECKING, Any

from morse.core.clients.budget import CLIENT_BYTES
from morse.core.clients.complaints import Complaints
from morse.core.exceptions import MorseMiddlewareError
from morse.middleware.moos.mapping import INSTALL
from morse.middleware.moos.packets import HEADER, check_packet

if TYPE_CHECKING:
    from collections.abc import Mapping

logger = logging.getLogger(__name__)

#: largest packet that is read, bytes, and number of messages that wait to be sent or read
_LARGEST, _MOST_MESSAGES = 4 << 20, 20_000
#: bytes of the packets that wait to be read
_MOST_BYTES = CLIENT_BYTES - _LARGEST
#: bytes of packets that are read in a wall-clock second: reading takes the time of the ticks
_MOST_PER_SECOND = 4 << 20
#: wall-clock seconds in which the database must begin to answer, and complete its answer
_TIMEOUT, _WHOLE_ANSWER = 5.0, 20.0


class Database:
    """Sends and receives in its own thread; no call waits for the database.

    Args:
        options: see `morse.middleware.moos.mapping.MANAGER_OPTIONS`.

    Attributes:
        connections: number of connections that `received` has noticed.

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
        self.connections = 0
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
        connected, refusal = self.connected, self._client.refusal
        self._client.refusal = ""
        if connected and not self._was_connected:
            self.connections += 1
            self._complaints.log(logging.INFO, "connected", f"moos: connected to the database {self.place}")
        elif self._was_connected and not connected:
            because = f": {refusal}" if refusal else ""
            self._complaints.warn("gone", f"moos: the database {self.place} has disconnected{because}")
        elif refusal:
            self._complaints.warn("refused", f"moos: the database {self.place} is not used: {refusal}")
        self._was_connected = connected
        return [(message.key, message.val if message.is_double() else message.sval) for message in self._client.fetch()]

    def close(self) -> None:
        """Disconnect."""
        self._client.stop()


def _made(base: Any, unpack: Any) -> Any:
    """The client of pymoos2, which survives whatever a database sends."""

    class Client(base):  # type: ignore[misc]
        #: why the last connection ended, for the log
        refusal = ""
        _answered_by = 0.0
        _unread = 0

        def _connect(self) -> None:
            try:
                super()._connect()
            except (OSError, AttributeError) as error:
                self._close()
                self._note(error)
                raise ConnectionError(self.refusal) from None

        def _note(self, error: Exception) -> None:
            self.refusal = self.refusal or getattr(error, "strerror", None) or str(error) or type(error).__name__

        def _send_raw(self, data: bytes) -> None:
            connection = self._sock
            if connection is None:
                raise ConnectionError("closed")
            connection.settimeout(_TIMEOUT)
            try:
                connection.sendall(data)
            except OSError as error:
                self._note(error)
                raise

        def _recv_raw(self, count: int) -> bytes:
            data, connection = bytearray(), self._sock
            while len(data) < count:
                part = connection.recv(count - len(data)) if connection is not None else b""
                if not part:
                    raise ConnectionError("it has closed the connection")
                data += part
                if time.monotonic() > self._answered_by:
                    raise ConnectionError("its answer takes too long")
            return bytes(data)

        def _recv_pkt(self) -> Any:
            try:
                return self._read_packet()
            except OSError as error:
                self._note(error)
                raise

        def _read_packet(self) -> Any:
            self._answered_by = time.monotonic() + _WHOLE_ANSWER
            header = self._recv_raw(4)
            (size,) = struct.unpack("<i", header)
            if not HEADER <= size <= _LARGEST:
                raise ConnectionError(f"a packet of {size} bytes")
            packet = header + self._recv_raw(size - 4)
            try:
                check_packet(packet, _MOST_MESSAGES)
                messages = unpack(packet)
            except Exception as error:  # it would end the thread of the connection
                raise ConnectionError(f"a packet cannot be read ({error})") from None
            time.sleep(min(1.0, size / _MOST_PER_SECOND))
            self._unread = self._unread + size if self._inbox else size
            if len(self._inbox) + len(messages) > _MOST_MESSAGES or self._unread > _MOST_BYTES:
                raise ConnectionError("it sends more messages than are read")
            return messages

        def _close(self) -> None:
            connection = self._sock
            if connection is not None:
                with contextlib.suppress(OSError):  # ends a pending receive
                    connection.shutdown(socket.SHUT_RDWR)
            super()._close()

    return Client
