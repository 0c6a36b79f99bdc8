"""Accepts the connections to one port, and decides who has to leave if there are too many."""

from __future__ import annotations

import asyncio
import contextlib
import errno
import os
import socket
import threading
import time
from time import monotonic, perf_counter
from typing import TYPE_CHECKING, Any, Protocol
from weakref import WeakKeyDictionary

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from morse.core.clients.complaints import Complaints


__all__ = ["DESCRIPTORS", "Acceptor", "Acceptors", "ClientConnection", "Descriptors", "acceptors_of"]


#: maximum number of connections; on Windows, `select` takes 512 sockets
_MOST = 1 << 14 if os.name == "posix" else 384
#: part of the limit that the process keeps for recordings, files and reloads, and the bounds of this reserve
_PART, _LEAST_RESERVE, _LARGEST_RESERVE = 4, 16, 128
#: wall-clock seconds for which a measurement is valid
_LASTING = 0.25
#: where the system lists the descriptors of a process
_LISTS = ("/proc/self/fd", "/dev/fd")


class Descriptors:
    """Divides the descriptors between the connections of clients and everything else.

    The limit applies to the process, so that all servers of all its simulations share one budget. Any thread may use
    it.
    """

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._clients = 0
        self._allowed = 0
        self._until = 0.0

    def has_room(self, *, measure: bool = False) -> bool:
        """Whether one more connection may be opened.

        Args:
            measure: whether to count the descriptors now, not only four times per second.
        """
        with self._lock:
            now = time.monotonic()
            if measure or now >= self._until:
                self._until = now + _LASTING
                self._allowed = self._measured()
            return self._clients < self._allowed

    def enter(self) -> None:
        """Count a connection of a client."""
        with self._lock:
            self._clients += 1

    def leave(self) -> None:
        """A connection of a client has ended."""
        with self._lock:
            self._clients -= 1

    def _measured(self) -> int:
        """The number of connections that clients may have."""
        limit, in_use = _limit(), _in_use()
        if limit is None or in_use is None:
            return _MOST
        free = max(0, limit - max(0, in_use - self._clients))
        reserve = min(_LARGEST_RESERVE, max(_LEAST_RESERVE, limit // _PART))
        # a scene with many ports leaves less than the reserve: then its clients get half of the rest
        return min(_MOST, max(free - reserve, free // 2))


def _limit() -> int | None:
    with contextlib.suppress(ImportError, OSError, ValueError):
        import resource  # not available on Windows, which has no such limit

        soft, _ = resource.getrlimit(resource.RLIMIT_NOFILE)
        return None if soft == resource.RLIM_INFINITY else soft
    return None


def _in_use() -> int | None:
    for folder in _LISTS:
        try:
            return len(os.listdir(folder)) - 1  # without that of the list itself
        except OSError:
            continue
    try:
        # the list needs a descriptor: there is none
        number = os.dup(0)
    except OSError:
        return _limit()
    os.close(number)
    return None


DESCRIPTORS = Descriptors()
"""Those of this process."""


#: connections that wait in the system until they are accepted; others have to try again after a second
_BACKLOG = 1024
#: limits for one turn of the event loop: accepted connections, wall-clock seconds, and connections that have to leave.
#: Between two turns, the data of all other connections are read
_AT_A_TIME, _TURN, _LEAVING = 64, 0.002, 8
#: wall-clock seconds without accepting connections after the system could not create a socket
_PAUSE = 1.0
#: the process, or the system, has no file descriptor for another socket
_NO_DESCRIPTOR = (errno.EMFILE, errno.ENFILE)


class ClientConnection(Protocol):
    """A connection of a client."""

    @property
    def keeps_place(self) -> bool:
        """Whether it has sent something valid: it does not have to leave for a new connection."""

    def importance(self) -> tuple[float, ...]:
        """Of the others, the connection with the lowest importance has to leave first."""

    def dismiss(self) -> None:
        """Close the connection because another one needs its place."""


class Acceptors:
    """The acceptors that share a thread.

    Attributes:
        acceptors: the open acceptors.
        leaving: number of connections that are about to be closed.
    """

    def __init__(self) -> None:
        self.acceptors: set[Acceptor] = set()
        self.leaving = 0

    @property
    def count(self) -> int:
        """The number of connections."""
        return sum(len(acceptor.connections) for acceptor in self.acceptors)

    def most_dispensable(self) -> Acceptor | None:
        """The acceptor with the most connections that may have to leave; None if all keep their places."""
        acceptor = max(self.acceptors, key=lambda acceptor: len(acceptor.dispensable()), default=None)
        return acceptor if acceptor is not None and acceptor.dispensable() else None


_by_loop: WeakKeyDictionary[asyncio.AbstractEventLoop, Acceptors] = WeakKeyDictionary()


def acceptors_of(loop: asyncio.AbstractEventLoop) -> Acceptors:
    """The acceptors of an event loop."""
    return _by_loop.setdefault(loop, Acceptors())


class Acceptor:
    """Accepts connections while there are places and file descriptors.

    If there are too many connections, one that has not sent anything valid is closed, else the new one. A connection
    that its client has reset meanwhile costs nothing but the call of the system that accepts it.

    Args:
        name: name of the server in messages.
        enter: called with the socket and the address of a new connection; it calls `join`.
        most: maximum number of connections.
        complaints: where refused connections are logged.
        refusal: bytes that a client gets before its connection is closed because there is no place for it.

    Attributes:
        connections: the connections.
    """

    def __init__(
        self,
        name: str,
        enter: Callable[[socket.socket, Any], object],
        *,
        most: int,
        complaints: Complaints,
        refusal: bytes = b"",
    ) -> None:
        self.name = name
        self.connections: set[Any] = set()
        self._enter, self._most, self._complaints, self._refusal = enter, most, complaints, refusal
        self._listeners: list[socket.socket] = []
        self._acceptors = Acceptors()
        self._loop: asyncio.AbstractEventLoop | None = None
        self._watch: Callable[[socket.socket], object] = lambda _: None
        self._ignore: Callable[[socket.socket], object] = lambda _: None

    def open(
        self,
        listener: socket.socket,
        loop: asyncio.AbstractEventLoop | None = None,
        watch: Callable[[socket.socket, Callable[[], None]], object] | None = None,
        ignore: Callable[[socket.socket], object] | None = None,
    ) -> None:
        """Start accepting.

        Args:
            listener: a bound socket.
            loop: the event loop that accepts; None if the caller calls `accept` again and again.
            watch: called with the listener and the function for when it is readable, instead of ``loop.add_reader``.
            ignore: called with the listener, instead of ``loop.remove_reader``.
        """
        listener.listen(_BACKLOG)
        listener.setblocking(False)
        self._listeners.append(listener)
        if loop is not None:
            self._loop, self._acceptors = loop, acceptors_of(loop)
            add = watch if watch is not None else loop.add_reader
            self._watch = lambda one: add(one, lambda: self._accept_from(one))
            self._ignore = ignore if ignore is not None else loop.remove_reader
        self._acceptors.acceptors.add(self)
        self._watch(listener)

    @property
    def listeners(self) -> list[socket.socket]:
        """The sockets that listen."""
        return list(self._listeners)

    def close(self) -> None:
        """Stop accepting; the connections stay."""
        for listener in self._listeners:
            self._ignore(listener)
            listener.close()
        self._listeners.clear()
        self._acceptors.acceptors.discard(self)

    def join(self, place: ClientConnection) -> None:
        """Add a connection."""
        self.connections.add(place)
        DESCRIPTORS.enter()

    def leave(self, place: ClientConnection) -> None:
        """Remove a connection that is closed; it may be called again."""
        if place in self.connections:
            self.connections.discard(place)
            DESCRIPTORS.leave()

    def dispensable(self) -> list[Any]:
        """The connections that may have to leave."""
        return [place for place in self.connections if not place.keeps_place]

    def make_room(self) -> bool:
        """Close the least important connection; False if all keep their places."""
        leaving = min(self.dispensable(), key=lambda place: place.importance(), default=None)
        if leaving is None:
            return False
        peer = getattr(leaving, "peer", "a silent connection")
        text = f"{self.name}: {peer} is disconnected to make room: there are {len(self.connections)} clients"
        self._complaints.warn("many", text)
        leaving.dismiss()
        self.leave(leaving)
        if self._loop is not None:
            # its socket is closed in the next turn
            self._acceptors.leaving += 1
            self._loop.call_soon(self._has_left)
        return True

    # -- accepting ---------------------------------------------------------------------------

    def accept(self) -> None:
        """Accept the connections that wait."""
        for listener in self.listeners:
            self._accept_from(listener)

    def _accept_from(self, listener: socket.socket) -> None:
        until = perf_counter() + _TURN
        for _ in range(_AT_A_TIME):
            if self._acceptors.leaving >= _LEAVING or perf_counter() > until or listener not in self._listeners:
                return
            try:
                sock, address = listener.accept()
            except (BlockingIOError, InterruptedError):
                return
            except ConnectionError:
                continue  # the client has left
            except OSError as error:
                # without a descriptor, nobody is accepted for whom another one could leave
                if error.errno not in _NO_DESCRIPTOR or not self._make_room_anywhere():
                    self._pause(listener, error)
                return
            sock.setblocking(False)
            if _is_reset(sock):
                sock.close()
            elif not self._has_place():
                self._refuse(sock)
            else:
                self._enter(sock, address)

    def _has_place(self) -> bool:
        if len(self.connections) >= self._most:
            return self.make_room()
        if DESCRIPTORS.has_room():
            return True
        return self._make_room_anywhere()

    def _make_room_anywhere(self) -> bool:
        fullest = self._acceptors.most_dispensable()
        return fullest is not None and fullest.make_room()

    def _refuse(self, sock: socket.socket) -> None:
        why = f"all {len(self.connections)} connections are in use"
        if len(self.connections) < self._most:
            why = "the limit of open files of the process leaves no more connections (ulimit -n)"
        self._complaints.warn("full", f"{self.name}: a client is refused: {why}")
        with contextlib.suppress(OSError), sock:
            # bytes that are not read would turn the end into a reset, which discards the refusal
            with contextlib.suppress(BlockingIOError):
                sock.recv(1 << 16)
            if self._refusal:
                sock.send(self._refusal)

    def _pause(self, listener: socket.socket, error: OSError) -> None:
        self._complaints.warn("accept", f"{self.name}: nobody can connect for a while: {error.strerror}")
        if self._loop is not None:
            self._ignore(listener)
            self._loop.call_later(_PAUSE, self._resume, listener)

    def _resume(self, listener: socket.socket) -> None:
        if listener in self._listeners:
            self._watch(listener)

    def _has_left(self) -> None:
        self._acceptors.leaving -= 1


def _is_reset(sock: socket.socket) -> bool:
    try:
        sock.recv(1, socket.MSG_PEEK)
    except (BlockingIOError, InterruptedError):
        return False
    except OSError:
        return True
    return False


class StreamConnection:
    """A connection with a transport of asyncio.

    Attributes:
        stage: how far it has come; of those that may have to leave, the lowest leaves first, then the oldest.
        keeps_place: see `morse.core.clients.acceptors.ClientConnection`.
    """

    def __init__(self, acceptor: Acceptor) -> None:
        self._acceptor = acceptor
        self._transport: Any = None
        self._since = monotonic()
        self._is_dismissed = False
        self.stage = 0
        self.keeps_place = False

    def importance(self) -> tuple[float, ...]:
        """See `morse.core.clients.acceptors.ClientConnection`."""
        return (self.stage, self._since)

    def give_way(self) -> None:
        """Let it be the first to leave if there are too many."""
        self.stage, self.keeps_place = 0, False

    def begin(self, transport: Any) -> None:
        """The connection has a transport."""
        self._transport = transport
        if self._is_dismissed:
            transport.abort()

    def dismiss(self) -> None:
        """See `morse.core.clients.acceptors.ClientConnection`."""
        self._is_dismissed = True
        self._acceptor.leave(self)
        if self._transport is not None:
            self._transport.abort()

    def end(self) -> None:
        """The connection is closed."""
        self._acceptor.leave(self)


class AcceptedProtocol(asyncio.Protocol):
    """A base of protocols whose connections come through a `StreamAcceptor`.

    Attributes:
        place: the connection; set before `connection_made`.
    """

    place: StreamConnection

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """See `asyncio.Protocol`."""
        self.place.begin(transport)
        super().connection_made(transport)

    def connection_lost(self, exc: Exception | None) -> None:
        """See `asyncio.Protocol`."""
        self.place.end()
        super().connection_lost(exc)


class StreamAcceptor(Acceptor):
    """Accepts connections for protocols of asyncio.

    Args:
        name, most, complaints, refusal: see `morse.core.clients.acceptors.Acceptor`.
    """

    def __init__(self, name: str, *, most: int, complaints: Complaints, refusal: bytes = b"") -> None:
        super().__init__(name, self._accepted, most=most, complaints=complaints, refusal=refusal)
        self._factory: Callable[[], Any]
        self._joining: set[asyncio.Task[None]] = set()

    def serve(self, listeners: Iterable[socket.socket], factory: Callable[[], object]) -> AcceptorServer:
        """Start accepting in the running loop.

        Args:
            listeners: bound sockets.
            factory: makes the protocol of a connection, a `AcceptedProtocol`.
        """
        self._factory = factory
        loop = asyncio.get_running_loop()
        for listener in listeners:
            self.open(listener, loop)
        return AcceptorServer(self, loop)

    def _accepted(self, sock: socket.socket, _: object) -> None:
        place = StreamConnection(self)
        self.join(place)
        task = asyncio.get_running_loop().create_task(self._join(sock, place))
        self._joining.add(task)
        task.add_done_callback(self._joining.discard)

    async def _join(self, sock: socket.socket, place: StreamConnection) -> None:
        def protocol() -> Any:
            protocol = self._factory()
            protocol.place = place
            return protocol

        try:
            await asyncio.get_running_loop().connect_accepted_socket(protocol, sock)
        except OSError:  # the client has left
            place.end()
            with contextlib.suppress(OSError):
                sock.close()


class AcceptorServer(asyncio.AbstractServer):
    """A server in the form of asyncio, whose connections come through an acceptor."""

    def __init__(self, acceptor: StreamAcceptor, loop: asyncio.AbstractEventLoop) -> None:
        self._acceptor, self._loop = acceptor, loop
        self._is_serving = True

    @property
    def sockets(self) -> tuple[socket.socket, ...]:
        """The sockets that listen."""
        return tuple(self._acceptor.listeners)

    def close(self) -> None:
        """Stop accepting."""
        self._is_serving = False
        self._acceptor.close()

    def is_serving(self) -> bool:
        """Whether it accepts connections."""
        return self._is_serving

    def get_loop(self) -> asyncio.AbstractEventLoop:
        """The event loop."""
        return self._loop

    async def start_serving(self) -> None:
        """Nothing is left to do: `StreamAcceptor.serve` has started it."""

    async def serve_forever(self) -> None:
        """Nothing is left to do: the loop of the simulation runs until its end."""

    async def wait_closed(self) -> None:
        """Nothing is awaited: the owner of a connection awaits its end."""
