"""Limits for what a broker sends, which hold before paho-mqtt reads it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import socket
    import ssl
    from collections.abc import Callable

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
