"""Exchanges packets with a MOOS database: the client sends a packet, and the database answers with one."""

from __future__ import annotations

import contextlib
import socket
import struct
import threading
import time
from typing import TYPE_CHECKING

from pymoos2.core import constants
from pymoos2.core.MOOSCommPkt import pack, unpack
from pymoos2.core.MOOSMsg import MOOSMsg

from morse.core.clients.budget import CLIENT_BYTES
from morse.plugins.moos.packets import HEADER, check_packet

if TYPE_CHECKING:
    from collections.abc import Callable

#: largest packet that is read, bytes, and number of messages that wait to be sent or read
_LARGEST, MOST_MESSAGES = 4 << 20, 20_000
#: bytes of the packets that wait to be read
_MOST_BYTES = CLIENT_BYTES - _LARGEST
#: bytes of packets that are read in a wall-clock second: reading takes the time of the ticks
_MOST_PER_SECOND = 4 << 20
#: wall-clock seconds in which the database must begin to answer, and complete its answer
_TIMEOUT, _WHOLE_ANSWER = 5.0, 20.0
#: wall-clock seconds between two attempts to connect
_PAUSE = 1.0


class Exchange:
    """A connection to a database, in a thread of its own; after an error, it connects again.

    Args:
        host, port: address of the database.
        name: name of the client.
        rate: exchanges per wall-clock second.

    Attributes:
        is_connected: whether the database has accepted the client.
        connections: number of connections so far.
        refusal: why the last connection ended.
    """

    def __init__(self, host: str, port: int, name: str, rate: float) -> None:
        self.is_connected, self.connections, self.refusal = False, 0, ""
        self._address, self._name, self._period = (host, port), name, 1.0 / rate
        self._socket: socket.socket | None = None
        self._lock = threading.Lock()
        self._variables: set[str] = set()
        self._outgoing: list[MOOSMsg] = []
        self._incoming: list[MOOSMsg] = []
        self._unread = 0
        self._is_closed = threading.Event()
        self._thread = threading.Thread(target=self._serve, name="morse-moos", daemon=True)
        self._thread.start()

    # -- in the thread of the simulation -----------------------------------------------------

    def register(self, variable: str) -> None:
        """Receive a variable from now on, also after a new connection."""
        self._variables.add(variable)
        self._put(self._message(constants.MSG_REGISTER, variable))

    def unregister(self, variable: str) -> None:
        """Receive a variable no longer."""
        self._variables.discard(variable)
        self._put(self._message(constants.MSG_UNREGISTER, variable))

    def notify(self, variable: str, value: float | str) -> bool:
        """Queue a variable; False if too many of them wait."""
        if len(self._outgoing) >= MOST_MESSAGES:
            return False
        if isinstance(value, str):
            self._put(self._message(constants.MSG_NOTIFY, variable, sval=value))
        else:
            self._put(self._message(constants.MSG_NOTIFY, variable, val=float(value)))
        return True

    def fetch(self) -> list[MOOSMsg]:
        """Remove the messages that have arrived from the queue, and return them."""
        with self._lock:
            messages, self._incoming, self._unread = self._incoming, [], 0
        return messages

    def close(self) -> None:
        """Disconnect."""
        self._is_closed.set()
        self._end()
        self._thread.join(_TIMEOUT + _PAUSE)

    def _message(self, kind: int, key: str, **values: object) -> MOOSMsg:
        return MOOSMsg(kind, key, src=self._name, **values)

    def _put(self, message: MOOSMsg) -> None:
        if self.is_connected:
            with self._lock:
                self._outgoing.append(message)

    # -- in its own thread -------------------------------------------------------------------

    def _serve(self) -> None:
        while not self._is_closed.is_set():
            try:
                self._connect()
                while not self._is_closed.is_set():
                    begin = time.monotonic()
                    self._exchange()
                    self._is_closed.wait(max(0.0, self._period - (time.monotonic() - begin)))
            except (OSError, struct.error) as error:
                self.refusal = self.refusal or getattr(error, "strerror", None) or str(error) or type(error).__name__
            self._end()
            self._is_closed.wait(_PAUSE)

    def _connect(self) -> None:
        connection = self._socket = socket.create_connection(self._address, timeout=_TIMEOUT)
        connection.sendall(constants.PROTOCOL_STRING.ljust(constants.PROTOCOL_STRING_BUFFER_SIZE, b"\0"))
        connection.sendall(pack([self._message(constants.MSG_DATA, "", sval=self._name)]))
        answer, _ = self._receive(connection)
        if not answer:
            raise ConnectionError("its welcome is empty")
        if answer[0].msg_type == constants.MSG_POISON:
            raise ConnectionError(f"it refuses the client {self._name}: {answer[0].sval!r:.200}")
        with self._lock:
            self._outgoing = [self._message(constants.MSG_REGISTER, one) for one in sorted(self._variables)]
            self.connections += 1
            self.is_connected = True

    def _exchange(self) -> None:
        with self._lock:
            outgoing, self._outgoing = self._outgoing, []
        connection = self._socket
        if connection is None:
            raise ConnectionError("closed")
        connection.sendall(pack(outgoing or [self._message(constants.MSG_NULL, "")]))
        messages, size = self._receive(connection)
        news = [one for one in messages if one.msg_type != constants.MSG_NULL]
        with self._lock:
            self._unread += size if news else 0
            if len(self._incoming) + len(news) > MOST_MESSAGES or self._unread > _MOST_BYTES:
                raise ConnectionError("it sends more messages than are read")
            self._incoming += news
        self._is_closed.wait(min(1.0, size / _MOST_PER_SECOND))

    def _receive(self, connection: socket.socket) -> tuple[list[MOOSMsg], int]:
        """The messages of the next packet, and its size, bytes."""
        reader = _reader(connection, time.monotonic() + _WHOLE_ANSWER)
        header = reader(4)
        (size,) = struct.unpack("<i", header)
        if not HEADER <= size <= _LARGEST:
            raise ConnectionError(f"a packet of {size} bytes")
        packet = header + reader(size - len(header))
        try:
            check_packet(packet, MOST_MESSAGES)
            return unpack(packet), size
        except Exception as error:  # pymoos2 raises several errors
            raise ConnectionError(f"a packet cannot be read ({error})") from None

    def _end(self) -> None:
        self.is_connected = False
        connection, self._socket = self._socket, None
        if connection is not None:
            with contextlib.suppress(OSError):  # ends a pending receive
                connection.shutdown(socket.SHUT_RDWR)
            connection.close()


def _reader(connection: socket.socket, until: float) -> Callable[[int], bytes]:
    """Reads a number of bytes, at the latest until a time of `time.monotonic`."""

    def read(count: int) -> bytes:
        data = bytearray()
        while len(data) < count:
            part = connection.recv(min(count - len(data), 1 << 16))
            if not part:
                raise ConnectionError("it has closed the connection")
            data += part
            if time.monotonic() > until:
                raise ConnectionError("its answer takes too long")
        return bytes(data)

    return read
