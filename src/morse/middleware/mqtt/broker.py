"""The connection to a broker, which may be temporarily unavailable."""

from __future__ import annotations

import contextlib
import logging
import ssl
import threading
from collections import deque
from typing import TYPE_CHECKING, Any

from morse.core.clients.complaints import Complaints
from morse.core.exceptions import MorseMiddlewareError
from morse.middleware.mqtt import PORT, TLS_PORT
from morse.system.extras import install

if TYPE_CHECKING:
    import socket
    from collections.abc import Callable

    from morse.core.clients.budgets import Arrivals
    from morse.core.values import Options


#: largest packet that is received, bytes, and limits of the messages with QoS 2 that a broker has not completed
_LARGEST_PACKET, _MOST_INCOMPLETE, _MOST_INCOMPLETE_BYTES = 4 << 20, 64, 16 << 20
#: types of packets
_PUBLISH, _PUBREL = 3, 6
#: bytes of a packet that are looked at: a topic with its length, and the id of a message
_LOOKED_AT = 2 + 0xFFFF + 2


class PacketLimits:
    """Follows the packets in the bytes of a connection (MQTT 3.1.1, chapter 2.2).

    A header announces up to 256 MB, for which memory would be reserved at once; messages with QoS 2 are kept until the
    broker completes them.
    """

    def __init__(self) -> None:
        self._header = bytearray()
        self._beginning = bytearray()
        #: bytes of the packet that have not arrived; None while its header is read
        self._left: int | None = None
        self._size = 0
        self._incomplete: dict[bytes, int] = {}

    def pass_on(self, data: bytes) -> None:
        """Look at bytes that have arrived.

        Raises:
            ConnectionError: they exceed a limit; the message says which.
        """
        at = 0
        while at < len(data):
            if self._left is None:
                self._header.append(data[at])
                at += 1
                self._left = self._size_of_packet()
                self._size = self._left or 0
            else:
                part = data[at : at + self._left]
                at += len(part)
                self._left -= len(part)
                self._beginning += part[: _LOOKED_AT - len(self._beginning)]
            if self._left == 0:
                self._end_packet()

    def _size_of_packet(self) -> int | None:
        """The size after the header: 7 bits in each byte, the lowest ones first; None if the header is incomplete."""
        size = self._header[1:]
        if not size or (size[-1] & 0x80 and len(size) < 4):
            return None
        count = sum((byte & 0x7F) << 7 * place for place, byte in enumerate(size))
        if count > _LARGEST_PACKET:
            raise ConnectionError(f"a packet of {count} bytes, {_LARGEST_PACKET} are allowed")
        return count

    def _end_packet(self) -> None:
        kind, quality = self._header[0] >> 4, self._header[0] >> 1 & 3
        if kind == _PUBLISH and quality == 2:
            topic = int.from_bytes(self._beginning[:2], "big")
            number = bytes(self._beginning[2 + topic : 4 + topic])
            self._incomplete[number] = self._size
        elif kind == _PUBREL:
            self._incomplete.pop(bytes(self._beginning[:2]), None)
        self._header.clear()
        self._beginning.clear()
        self._left = None
        if len(self._incomplete) > _MOST_INCOMPLETE or sum(self._incomplete.values()) > _MOST_INCOMPLETE_BYTES:
            raise ConnectionError("it does not complete its messages with QoS 2")


class _LimitedSocket:
    """A connection to a broker whose packets are limited; otherwise the socket itself."""

    def __init__(self, connection: Any, refuse: Callable[[str], object]) -> None:
        self._connection, self._refuse, self._limits = connection, refuse, PacketLimits()

    def __getattr__(self, name: str) -> object:
        return getattr(self._connection, name)

    def do_handshake(self) -> None:
        """Establish the encryption, if there is one."""
        if hasattr(self._connection, "do_handshake"):
            self._connection.do_handshake()

    def pending(self) -> int:
        """Number of bytes that are decrypted, but not read."""
        return self._connection.pending() if hasattr(self._connection, "pending") else 0

    def recv(self, count: int) -> bytes:
        """Bytes of the broker.

        Raises:
            ConnectionError: they exceed a limit.
        """
        data: bytes = self._connection.recv(count)
        try:
            self._limits.pass_on(data)
        except ConnectionError as error:
            self._refuse(str(error))
            raise
        return data


class LimitedConnections:
    """Takes the place of an `ssl.SSLContext` in `paho.mqtt.client.Client.tls_set_context`: it wraps each new socket.

    Args:
        encryption: encrypts the connection; None for a connection in the clear.
        refuse: is called with the reason when a limit ends a connection.
    """

    def __init__(self, encryption: ssl.SSLContext | None, refuse: Callable[[str], object]) -> None:
        self._encryption, self._refuse = encryption, refuse
        #: whether the name of the broker is verified here; in the clear there is nothing to verify
        self.check_hostname = True

    def wrap_socket(self, connection: socket.socket, **options: Any) -> _LimitedSocket:
        """The limited form of a new connection."""
        stream = connection if self._encryption is None else self._encryption.wrap_socket(connection, **options)
        return _LimitedSocket(stream, self._refuse)


logger = logging.getLogger(__name__)

#: limits of the send queue: messages and bytes
_MOST_MESSAGES, _MOST_BYTES = 2000, 32 << 20
#: wall-clock seconds between two attempts to connect: initial and maximum value
_FIRST_PAUSE, _LONGEST_PAUSE = 1, 5
#: wall-clock seconds that the end waits for the thread
_FAREWELL = 3.0


class Broker:
    """Sends and receives in its own thread; no call waits for the broker.

    Args:
        options: see `morse.middleware.mqtt.MANAGER_OPTIONS`.
        arrivals: the share of the time for what the broker sends.

    Attributes:
        connected: whether the broker is connected.

    Raises:
        MorseMiddlewareError: paho-mqtt is not installed, or an option is invalid.
    """

    def __init__(self, options: Options, arrivals: Arrivals) -> None:
        self._arrivals = arrivals
        try:
            from paho.mqtt import client, enums
        except ImportError:
            raise MorseMiddlewareError(f"mqtt: paho-mqtt is not installed; to install it: {install('mqtt')}") from None
        self._host = options["host"]
        self._port = options["port"] or (TLS_PORT if options["tls"] else PORT)
        self._status = f"{options['prefix']}/status"
        self.connected = False
        self._takers: dict[str, tuple[int, Callable[[bytes], object]]] = {}
        self._pending: deque[tuple[Any, int]] = deque()
        self._pending_size = 0
        self._is_new = self._has_answered = self._has_asked = False
        self._closed = threading.Event()
        self._prefix = options["prefix"]
        self._refusal = ""
        self._complaints = Complaints(logger)
        try:
            self._client = client.Client(enums.CallbackAPIVersion.VERSION2, client_id=options["client_id"])
            if options["username"] is not None:
                self._client.username_pw_set(options["username"], options["password"])
            encryption = ssl.create_default_context() if options["tls"] else None
            self._client.tls_set_context(LimitedConnections(encryption, self._refuse))  # type: ignore[arg-type]
            self._client.will_set(self._status, b"offline", qos=1, retain=True)
            self._client.reconnect_delay_set(_FIRST_PAUSE, _LONGEST_PAUSE)
            self._client.max_queued_messages_set(_MOST_MESSAGES)
            # only the thread of the connection writes: a call from the tick must not wait
            self._client.on_socket_register_write = _nothing
            self._client.on_connect = self._on_connect
            self._client.on_connect_fail = self._on_connect_fail
            self._client.on_disconnect = self._on_disconnect
            self._client.on_message = self._on_message
            self._client.connect_async(self._host, self._port)
        except ValueError as error:
            raise MorseMiddlewareError(f"mqtt: {error}") from None
        self._thread = threading.Thread(target=self._serve, name="morse-mqtt", daemon=True)
        self._thread.start()

    @property
    def place(self) -> str:
        """Address of the broker."""
        return f"{self._host}:{self._port}"

    def listen(self, topic: str, qos: int, take: Callable[[bytes], object]) -> None:
        """Call ``take`` in the thread of the connection with each message of a topic."""
        self._takers = {**self._takers, topic: (qos, take)}
        if self.connected:
            self._client.subscribe(topic, qos)

    def ignore(self, topic: str) -> None:
        """End the subscription of a topic."""
        self._takers = {name: taker for name, taker in self._takers.items() if name != topic}
        if self.connected:
            self._client.unsubscribe(topic)

    def publish(self, topic: str, data: bytes, qos: int, retain: bool) -> None:
        """Send a message; it is dropped if the broker is not connected or too slow."""
        if not self.connected:
            return
        if self._is_new:
            # messages in transit to a broker that was lost are lost
            self._is_new = False
            self._pending.clear()
            self._pending_size = 0
        self._forget_sent()
        if len(self._pending) >= _MOST_MESSAGES or self._pending_size > _MOST_BYTES:
            self._complaints.warn("slow", f"mqtt: the broker {self.place} is too slow: messages are lost")
            return
        try:
            message = self._client.publish(topic, data, qos, retain)
        except ValueError as error:  # larger than MQTT allows
            self._complaints.warn(topic, f"mqtt: a message for {topic} is left out: {error}")
            return
        if message.rc == 0:
            self._pending.append((message, len(data)))
            self._pending_size += len(data)

    def _forget_sent(self) -> None:
        while self._pending and self._pending[0][0].is_published():
            self._pending_size -= self._pending.popleft()[1]

    def close(self) -> None:
        """Send the remaining messages if there is a broker, and disconnect."""
        if self.connected:
            farewell = self._client.publish(self._status, b"offline", qos=1, retain=True)
            with contextlib.suppress(RuntimeError, ValueError):  # the broker may have disconnected in the meantime
                farewell.wait_for_publish(1.0)
        self._closed.set()
        self._client.disconnect()
        self._thread.join(_FAREWELL)

    # -- in the thread of the connection -----------------------------------------------------

    def _serve(self) -> None:
        while True:
            try:
                self._client.loop_forever(retry_first_connection=True)
                return
            except Exception as error:  # paho-mqtt raises several errors for packets that are none
                self._refuse(f"a packet cannot be read ({error})")
            self._is_gone(self._refusal)
            connection = self._client.socket()
            if connection is not None:
                connection.close()
            if self._closed.wait(_FIRST_PAUSE):
                return
            with contextlib.suppress(OSError):  # it tries again in its loop
                self._client.reconnect()
            if self._closed.is_set():  # meanwhile; the loop sends this and returns
                self._client.disconnect()

    def _refuse(self, reason: str) -> None:
        """Note why the present connection is ended."""
        self._refusal = reason

    def _on_connect(self, client: Any, userdata: object, flags: object, reason: Any, properties: object) -> None:
        self._has_answered = True
        if reason.is_failure:
            self._complaints.warn("refused", f"mqtt: the broker {self.place} refuses the connection: {reason}")
            return
        for topic, (qos, _) in self._takers.items():
            client.subscribe(topic, qos)
        if not self._has_asked:
            # before the own status, which would replace it; later, the broker may still have this simulation as online
            self._has_asked = True
            client.subscribe(self._status, 1)
        client.publish(self._status, b"online", qos=1, retain=True)
        self._is_new = self.connected = True
        # a broker may break every connection
        self._complaints.log(logging.INFO, "connected", f"mqtt: connected to the broker {self.place}")

    def _on_connect_fail(self, client: object, userdata: object) -> None:
        self._complaints.warn(
            "absent", f"mqtt: there is no broker at {self.place}; the simulation continues without it"
        )

    def _on_disconnect(self, client: object, userdata: object, flags: object, reason: Any, properties: object) -> None:
        if self.connected:
            self._is_gone((self._refusal or str(reason)) if reason.is_failure else "")
        elif reason.is_failure and not self._has_answered:
            text = f"mqtt: what is at {self.place} does not answer as a broker; the simulation continues without it"
            self._complaints.warn("absent", text)
        self._refusal, self._has_answered = "", False

    def _is_gone(self, because: str) -> None:
        self.connected = False
        if because:
            self._complaints.warn("gone", f"mqtt: the broker {self.place} has disconnected: {because}")

    def _on_message(self, client: object, userdata: object, message: Any) -> None:
        if message.topic == self._status and message.retain and message.payload == b"online":
            self._complaints.warn(
                "shared",
                f"mqtt: {self._status} is 'online' already: another simulation uses the broker {self.place} with the "
                f"prefix '{self._prefix}', so that both send on the same topics and receive the same commands; set "
                "another one: env.configure_stream_manager('mqtt', prefix='...')",
            )
        taker = self._takers.get(message.topic)
        if taker is not None:
            taker[1](message.payload)
        self._arrivals.received()


def _nothing(*_arguments: object) -> None:
    """The loop finds by itself what there is to write."""
