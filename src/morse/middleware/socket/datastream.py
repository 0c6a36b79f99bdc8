"""Carries data streams over TCP, each component on a port of its own."""

from __future__ import annotations

import logging
from collections import deque
from typing import TYPE_CHECKING, Any

from morse.core.classpath import load_class
from morse.core.datastream import DatastreamManager
from morse.core.exceptions import MorseMiddlewareError
from morse.core.values import nearest
from morse.middleware.socket.directory import StreamDirectory
from morse.middleware.socket.lines import close_all
from morse.middleware.socket.listener import allow_many_sockets, listen, port_of
from morse.middleware.socket.stream_client import StreamServer
from morse.middleware.socket.streams import SocketStream
from morse.middleware.socket.time_sync import SYNC_PORT, TimeSync

if TYPE_CHECKING:
    from morse.core.context import Context
    from morse.core.object import Object
    from morse.scene import StreamDeclaration

logger = logging.getLogger("morse." + __name__)

FIRST_PORT = 60000
_LAST_PORT = 65535
_OPTIONS = ("time_sync", "sync_port")


class SocketDatastreamManager(DatastreamManager):
    """Streams as lines of JSON, from port 60000 upward.

    A stream with the option ``port`` takes that one. Ports in use are skipped.

    Options of ``env.configure_stream_manager('socket', ...)``: ``time_sync=True`` has a client pace
    the simulation (see `TimeSync`), on ``sync_port``, 6000 if it is not given.
    """

    classpath = "morse.middleware.socket_datastream.SocketDatastreamManager"

    def __init__(self, options: dict[str, Any], context: Context) -> None:
        super().__init__(options, context)
        self._servers: dict[str, StreamServer] = {}
        self._ports: dict[str, int] = {}
        self._streams: dict[tuple[str, str], SocketStream] = {}
        self._outbox: list[tuple[StreamServer, bytes]] = []
        self._parcels: deque[list[tuple[StreamServer, bytes]]] = deque()
        self._posted = False
        self._next_port = FIRST_PORT
        self._sync = self._make_sync()
        allow_many_sockets()
        context.services.register_object("simulation", StreamDirectory(self._ports))

    def _make_sync(self) -> TimeSync | None:
        for name in self.options:
            if name not in _OPTIONS:
                raise MorseMiddlewareError(f"the socket has no option '{name}'{nearest(name, list(_OPTIONS))}")
        if not self.options.get("time_sync"):
            return None
        port = _port(self.options.get("sync_port", SYNC_PORT), "sync_port")
        sync = TimeSync(self.context, listen(self.context.host, [port]))
        self.context.network.call(sync.start())
        logger.info("a client of port %d may pace the simulation", port)
        return sync

    def register_component(self, component: Object, declaration: StreamDeclaration) -> None:
        """Give a component a stream.

        Raises:
            MorseMiddlewareError: no port for it, or its class is no socket stream.
        """
        name = component.name()
        cls = load_class(declaration.stream)
        if not issubclass(cls, SocketStream):
            raise MorseMiddlewareError(
                f"{declaration.stream} is no stream of the socket: it is to be a subclass of "
                "morse.middleware.socket_datastream.SocketPublisher or SocketReader"
            )
        stream = cls(component, dict(declaration.options))
        stream.server = self._server(name, declaration.options.get("port"))
        stream.outbox = self._outbox
        if (previous := self._streams.get((name, declaration.direction))) is not None:
            previous.finalize()
        self._streams[name, declaration.direction] = stream
        if declaration.direction == "IN":
            stream.server.reads = True
            stream.server.inbox.take()
            component.input_functions.append(stream.default)
        else:
            component.output_functions.append(stream.default)
        stream.initialize()

    def _server(self, name: str, hint: Any) -> StreamServer:
        if name in self._servers:
            return self._servers[name]
        first = self._next_port if hint is None else _port(hint, f"the option 'port' of {name}")
        listener = listen(self.context.host, range(first, _LAST_PORT + 1) if first else (0,))
        port = port_of(listener)
        if hint is None:
            self._next_port = port + 1
        elif hint not in (0, port):
            logger.warning("%s: port %d is in use, its stream is on port %d", name, hint, port)
        server = StreamServer(name, listener)
        self.context.network.call(server.start(self.context.network))
        self._servers[name] = server
        self._ports[name] = port
        return server

    def action(self) -> None:
        """A tick begins: wait for the client that paces the simulation, if there is one."""
        if self._sync is not None:
            self._sync.wait()

    def flush(self) -> None:
        """A tick ends: hand all that was published to the network thread, in one parcel."""
        if not self._outbox:
            return
        self._parcels.append(self._outbox.copy())
        self._outbox.clear()
        if not self._posted:
            self._posted = True
            self.context.network.post(self._send)

    def _send(self) -> None:
        # Ticks may come faster than this thread gets its turn: what has gathered goes to each client at once,
        # so that the more there is, the less each message takes
        self._posted = False
        messages: dict[StreamServer, list[bytes]] = {}
        while self._parcels:
            for server, message in self._parcels.popleft():
                messages.setdefault(server, []).append(message)
        for server, published in messages.items():
            server.publish(published)

    def sent(self) -> dict[str, int]:
        """Number of messages sent to each client of a sensor; to be called in the network thread.

        The key is its address and the port of the stream: clients of two ports may have the same address.
        """
        return {
            f"{client.peer} {self._ports[name]}": client.sent
            for name, server in self._servers.items()
            for client in server.clients
            if client.sent
        }

    def finalize(self) -> None:
        """Send what is left and close."""
        for stream in self._streams.values():
            stream.finalize()
        self.flush()
        self.context.network.call(self._close())

    async def _close(self) -> None:
        if self._sync is not None:
            await self._sync.close()
        await close_all(self._servers.values())


def _port(value: Any, what: str) -> int:
    if isinstance(value, bool) or not isinstance(value, int) or not 0 <= value <= _LAST_PORT:
        raise MorseMiddlewareError(f"{what} is a port number from 1 to {_LAST_PORT} (0: any free one), not {value!r}")
    return value
