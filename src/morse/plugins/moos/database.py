"""The connection to a MOOS database, which may be temporarily unavailable."""

from __future__ import annotations

import contextlib
import logging
import socket
import struct
import threading
import time
from collections import deque
from importlib.util import find_spec
from typing import TYPE_CHECKING

from morse.core.clients.budgets import CLIENT_BYTES
from morse.core.clients.complaints import Complaints
from morse.core.exceptions import MorseMiddlewareError
from morse.system.extras import install

try:
    from pymoos2.core import constants
    from pymoos2.core.MOOSCommPkt import pack, unpack
    from pymoos2.core.MOOSMsg import MOOSMsg
except ImportError:
    pass  # `Database` says how to install it

if TYPE_CHECKING:
    from collections.abc import Callable

    from morse.core.values import Options


#: bytes of the header of a packet
HEADER = 9
_SIZE = struct.Struct("<i")
#: bytes of a message before the first string, and bytes before each string, in addition to its size
_LEAD, _BEFORE_STRINGS = 10, (0, 0, 0, 0, 24)


def check_packet(data: bytes, most: int) -> None:
    """Check that each message of a packet, and each string of a message, is inside of it.

    Otherwise the same bytes could be read again and again: a packet of 70 bytes announced two billion messages.

    Args:
        data: the packet.
        most: maximum number of messages.

    Raises:
        ValueError: it is not such a packet.
        struct.error: it ends too early.
    """
    (count,) = _SIZE.unpack_from(data, 4)
    if not 0 <= count <= most:
        raise ValueError(f"{count} messages in a packet, at most {most} are allowed")
    begin = HEADER
    for _ in range(count):
        end = begin + _SIZE.unpack_from(data, begin)[0]
        at = begin + _LEAD
        for numbers in _BEFORE_STRINGS:
            at += numbers
            (length,) = _SIZE.unpack_from(data, at)
            at += _SIZE.size + length
            if length < 0 or at > end:
                raise ValueError(f"a string of {length} bytes is not inside of its message")
        if end > len(data):
            raise ValueError("a message is longer than its packet")
        begin = end


#: largest packet that is read, bytes, and number of messages that wait to be sent or read
_LARGEST, MOST_MESSAGES = 4 << 20, 20_000
#: bytes of the packets that wait to be read
_MOST_BYTES = CLIENT_BYTES - _LARGEST
#: bytes of packets that are read in a wall-clock second: reading takes the time of the ticks
_MOST_PER_SECOND = 4 << 20
#: values of a variable that are read in a tick
_MOST_VALUES = 16
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


logger = logging.getLogger(__name__)


class Database:
    """Sends and receives in its own thread; no call waits for the database.

    Args:
        options: see `morse.plugins.moos.MANAGER_OPTIONS`.

    Raises:
        MorseMiddlewareError: pymoos2 is not installed.
    """

    def __init__(self, options: Options) -> None:
        if find_spec("pymoos2") is None:
            raise MorseMiddlewareError(f"moos: pymoos2 is not installed; to install it: {install('moos')}")
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
        """Return the variables that have arrived since the last call; log whether there is a database.

        Of many values of a variable, the last ones: to read or refuse all of them would take the time of the ticks.
        """
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
        latest: dict[str, deque[float | str]] = {}
        for message in self._exchange.fetch():
            values = latest.setdefault(message.key, deque(maxlen=_MOST_VALUES))
            values.append(message.val if message.is_double() else message.sval)
        return [(key, value) for key, values in latest.items() for value in values]

    def close(self) -> None:
        """Disconnect."""
        self._exchange.close()
