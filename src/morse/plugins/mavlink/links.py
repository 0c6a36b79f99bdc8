"""The sockets of MAVLink; all functions are non-blocking."""

from __future__ import annotations

import contextlib
import errno
import logging
import math
import socket
import time
from abc import ABC, abstractmethod
from typing import TYPE_CHECKING

from morse.core.clients.acceptors import Acceptor
from morse.core.clients.complaints import Complaints
from morse.core.exceptions import MorseMiddlewareError
from morse.core.reports.quoting import shown
from morse.plugins.mavlink.framing import V1, V2

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    _Address = tuple[str, int]

logger = logging.getLogger(__name__)

#: limits for one tick: packets, and bytes of a connection
_MOST_PACKETS, _MOST_BYTES = 64, 1 << 16
_MOST_PEERS = 16
#: wall-clock seconds for which a peer keeps its place after a valid message; autopilots and ground stations send one
#: per second
_SPEAKING = 10.0
#: maximum number of unsent bytes for a slow reader
_MOST_UNSENT = 1 << 20
#: wall-clock seconds between two attempts to connect
_PAUSE = 1.0
_UNDER_WAY = (errno.EINPROGRESS, errno.EWOULDBLOCK, errno.EAGAIN)


class Link(ABC):
    """A connection to one or several peers.

    Attributes:
        device: the device string of the script.
    """

    def __init__(self, device: str) -> None:
        self.device = device

    @abstractmethod
    def send(self, data: bytes) -> None:
        """Send to all peers; bytes that cannot be sent immediately are lost or queued."""

    @abstractmethod
    def receive(self) -> Iterator[tuple[object, bytes]]:
        """Return the received packets: sender and bytes."""

    def understood(self, sender: object) -> None:
        """A message of a sender was valid."""

    @abstractmethod
    def close(self) -> None:
        """Release the sockets."""


class UdpLink(Link):
    """Packets to a fixed address (``udpout``), or to all addresses from which packets arrived (``udpin``)."""

    def __init__(self, device: str, address: _Address, family: int, *, listens: bool) -> None:
        super().__init__(device)
        self._listens = listens
        #: those that were silent for longest come first; with the time of their last valid message, s
        self._peers: dict[_Address, float] = {}
        self._complaints = Complaints(logger)
        self._socket = socket.socket(family, socket.SOCK_DGRAM)
        self._socket.setblocking(False)
        try:
            (self._socket.bind if listens else self._socket.connect)(address)
        except OSError as error:
            self._socket.close()
            raise _refused(device, error) from None

    def send(self, data: bytes) -> None:
        """See `Link.send`."""
        for peer in self._peers if self._listens else (None,):
            with contextlib.suppress(OSError):  # no receiver, or the send buffer is full: the packet is lost
                self._socket.send(data) if peer is None else self._socket.sendto(data, peer)

    def receive(self) -> Iterator[tuple[object, bytes]]:
        """See `Link.receive`."""
        for _ in range(_MOST_PACKETS):
            try:
                data, address = self._socket.recvfrom(_MOST_BYTES)
            except (BlockingIOError, InterruptedError):
                return
            except OSError:  # the port of the peer is closed
                continue
            if self._listens:
                self._enter(address, self._peers.pop(address, -math.inf))
            yield address, data

    def _enter(self, peer: _Address, valid: float) -> None:
        """Add a peer; the one that has been silent for longest gives way, but none that speaks MAVLink."""
        if len(self._peers) >= _MOST_PEERS:
            earliest = time.monotonic() - _SPEAKING
            leaving = next((one for one, last in self._peers.items() if last < earliest), None)
            if leaving is None:
                text = f"mavlink: {self.device}: a peer gets no messages: there are {len(self._peers)} others"
                self._complaints.warn("full", text)
                return
            del self._peers[leaving]
        self._peers[peer] = valid

    def understood(self, sender: object) -> None:
        """See `Link.understood`."""
        if sender in self._peers:
            self._peers[sender] = time.monotonic()

    def close(self) -> None:
        """See `Link.close`."""
        self._socket.close()


class _Connection:
    """A TCP connection.

    Attributes:
        peer: the address of the other side.
        over: whether the connection has ended.
    """

    def __init__(
        self, sock: socket.socket, address: tuple[str, int] | None = None, leave: Callable[[_Connection], object] = bool
    ) -> None:
        self._socket, self._leave = sock, leave
        self._last_time = time.monotonic()
        self.peer = f"{address[0]}:{address[1]}" if address else "?"
        self._valid = -math.inf
        self._rest = bytearray()
        self._is_greeted = self.over = False
        sock.setblocking(False)
        with contextlib.suppress(OSError):
            sock.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)

    @property
    def keeps_place(self) -> bool:
        return time.monotonic() - self._valid < _SPEAKING

    def understood(self) -> None:
        """It has sent a message of MAVLink."""
        self._valid = time.monotonic()

    def send(self, data: bytes) -> None:
        if len(self._rest) + len(data) <= _MOST_UNSENT:
            self._rest += data
        try:
            del self._rest[: self._socket.send(self._rest)]
        except OSError as error:
            self._end_unless_busy(error)

    def receive(self) -> bytes:
        try:
            data = self._socket.recv(_MOST_BYTES)
        except OSError as error:
            self._end_unless_busy(error)
            return b""
        # a web page can make a browser send any byte, except as the first byte
        if not data or not (self._is_greeted or data[0] in (V1, V2)):
            self.end()
            return b""
        self._is_greeted = True
        self._last_time = time.monotonic()
        return data

    def _end_unless_busy(self, error: OSError) -> None:
        if error.errno not in (*_UNDER_WAY, errno.ENOTCONN, errno.EINTR):
            self.end()

    def importance(self) -> tuple[float, ...]:
        return (self._last_time,)

    def dismiss(self) -> None:
        self.end()

    def end(self) -> None:
        self.over = True
        self._socket.close()
        self._leave(self)


class TcpLink(Link):
    """Connects to an address repeatedly (``tcp``), or accepts connections (``tcpin``)."""

    def __init__(self, device: str, address: _Address, family: int, *, listens: bool) -> None:
        super().__init__(device)
        self._address, self._family = address, family
        self._connections: list[_Connection] = []
        self._next_attempt = 0.0
        self._acceptor: Acceptor | None = None
        if listens:
            listener = socket.socket(family, socket.SOCK_STREAM)
            listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            self._acceptor = Acceptor(f"mavlink: {device}", self._join, most=_MOST_PEERS, complaints=Complaints(logger))
            try:
                listener.bind(address)
                self._acceptor.open(listener)
            except OSError as error:
                listener.close()
                raise _refused(device, error) from None

    def _join(self, sock: socket.socket, address: tuple[str, int]) -> None:
        assert self._acceptor is not None
        one = _Connection(sock, address, self._acceptor.leave)
        self._acceptor.join(one)
        self._connections.append(one)

    def _look_for_others(self) -> None:
        if self._acceptor is not None:
            self._acceptor.accept()
        self._connections = [one for one in self._connections if not one.over]
        if self._acceptor is None and not self._connections and time.monotonic() >= self._next_attempt:
            self._next_attempt = time.monotonic() + _PAUSE
            sock = socket.socket(self._family, socket.SOCK_STREAM)
            sock.setblocking(False)
            if sock.connect_ex(self._address) in (0, *_UNDER_WAY):
                self._connections.append(_Connection(sock))
            else:
                sock.close()

    def send(self, data: bytes) -> None:
        """See `Link.send`."""
        for one in self._connections:
            if not one.over:
                one.send(data)

    def receive(self) -> Iterator[tuple[object, bytes]]:
        """See `Link.receive`."""
        self._look_for_others()
        for one in self._connections:
            data = one.receive()
            if data:
                yield one, data

    def understood(self, sender: object) -> None:
        """See `Link.understood`."""
        if isinstance(sender, _Connection):
            sender.understood()

    def close(self) -> None:
        """See `Link.close`."""
        for one in self._connections:
            one.end()
        if self._acceptor is not None:
            self._acceptor.close()


class SeveralLinks(Link):
    """Sends to several devices, and receives from all of them."""

    def __init__(self, device: str) -> None:
        super().__init__(device)
        self._links: list[Link] = []

    def add(self, link: Link) -> None:
        """Add the link of a device."""
        self._links.append(link)

    def send(self, data: bytes) -> None:
        """See `Link.send`."""
        for link in self._links:
            link.send(data)

    def receive(self) -> Iterator[tuple[object, bytes]]:
        """See `Link.receive`."""
        for link in self._links:
            yield from link.receive()

    def understood(self, sender: object) -> None:
        """See `Link.understood`."""
        for link in self._links:
            link.understood(sender)

    def close(self) -> None:
        """See `Link.close`."""
        for link in self._links:
            link.close()


_WAYS = {"udpout": (UdpLink, False), "udpin": (UdpLink, True), "udp": (UdpLink, True), "tcp": (TcpLink, False),
         "tcpin": (TcpLink, True)}  # fmt: skip


def _refused(device: str, error: OSError) -> MorseMiddlewareError:
    return MorseMiddlewareError(f"mavlink: the device {shown(device)} cannot be opened: {error.strerror}")


def open_link(device: str) -> Link:
    """The link of a device such as ``udpout:127.0.0.1:14550``, or of several, separated by commas.

    Raises:
        MorseMiddlewareError: the device does not exist, or cannot be opened.
    """
    if "," in device:
        several = SeveralLinks(device)
        try:
            for part in device.split(","):
                several.add(open_link(part.strip()))
        except MorseMiddlewareError:
            several.close()
            raise
        return several
    way, _, rest = device.partition(":")
    host, _, port = rest.rpartition(":")
    if way not in _WAYS or not host or not port.isdecimal() or not 0 < int(port) < 1 << 16:
        raise MorseMiddlewareError(
            f"mavlink: the device is {shown(device)}, expected {', '.join(_WAYS)} with an address and a port, such as "
            "'udpout:127.0.0.1:14550'"
        )
    try:
        family, *_, address = socket.getaddrinfo(host.strip("[]"), int(port))[0]
    except OSError as error:
        raise _refused(device, error) from None
    cls, listens = _WAYS[way]
    link: Link = cls(device, address, family, listens=listens)  # type: ignore[arg-type]
    logger.info("mavlink: %s %s", "listens to" if listens else "sends to", device.partition(":")[2])
    return link
