"""Sends and receives data streams over TCP, with one port per component; a client may pace the simulation."""

from __future__ import annotations

import logging
import time
from collections import deque
from time import perf_counter
from typing import TYPE_CHECKING, Any

from morse.core.abstractobject import AbstractObject
from morse.core.classes.classpath import load_class
from morse.core.datastream import DatastreamManager
from morse.core.exceptions import MorseMiddlewareError, MorseRPCInvokationError
from morse.core.mapping import maps
from morse.core.reports.quoting import nearest, short
from morse.core.services import service
from morse.core.streams.kind_stream import KindStream
from morse.middleware.socket import LAST_PORT, MANAGER_OPTIONS
from morse.middleware.socket.frames import FrameServer, data_frame, line_frame
from morse.middleware.socket.stream_client import StreamServer, publish_together
from morse.system import OF_MACHINE
from morse.wire.encoding import from_json, to_json
from morse.wire.images import PictureFields, cloud_fields, image_fields
from morse.wire.lines import LineClient
from morse.wire.listener import allow_many_sockets, listen, port_of
from morse.wire.server import LineServer, close_all

if TYPE_CHECKING:
    import socket
    from collections.abc import Callable, Collection, Iterable, Mapping

    from morse.core.context import Context
    from morse.core.kinds import Message
    from morse.core.object import Object
    from morse.core.values import Options
    from morse.middleware.socket.frames import FrameChannel
    from morse.scene import StreamDeclaration
    from morse.wire.connection import Connection


logger = logging.getLogger(__name__)

#: interval in which the waiting simulation thread checks whether the simulation is to end, s
_SLICE = 0.02
#: wall-clock time in which a client has to send its first bytes; later it no longer holds up the simulation, s
_PATIENCE = 30.0


class TimeSync:
    """A port for clients that pace the simulation.

    While at least one client is connected, a tick begins only after bytes have arrived since the
    beginning of the last tick; their number does not matter. Services are answered in the meantime.
    A client that sends nothing within 30 s does not hold up the simulation until it sends something.
    """

    def __init__(self, context: Context, listener: socket.socket) -> None:
        self._context = context
        self._is_open = False
        self._server = LineServer("time sync", listener, lambda server: _SyncClient(server, self))

    async def start(self) -> None:
        """Start accepting clients."""
        await self._server.start(self._context.network)

    async def close(self) -> None:
        """Stop pacing the simulation."""
        await self._server.close()

    def arrived(self) -> None:
        """Bytes have arrived; runs in the network loop."""
        self._context.network.when_read(self.release)

    def release(self) -> None:
        """Allow one tick, or note that no client paces the simulation any more; runs in the network loop."""
        self._is_open = True
        self._context.wake()

    def _is_paced(self) -> bool:
        clients = list(self._server.clients)
        if any(client.is_proven for client in clients):
            return True
        now = time.monotonic()
        for client in clients:
            if now - client.heard < _PATIENCE:
                return True
            text = f"time sync: {client.peer} sends nothing, so it no longer holds up the simulation"
            self._server.complaints.warn("silent", text)
        return False

    def wait(self) -> None:
        """Wait until the next tick is allowed; runs in the simulation thread."""
        while self._is_paced() and not self._is_open and not self._context.stopping():
            self._context.services.process()
            self._context.wait(_SLICE)
        self._is_open = False


class _SyncClient(LineClient):
    def __init__(self, server: LineServer, sync: TimeSync) -> None:
        super().__init__(server)
        self._sync = sync

    def connection_made(self, transport: Connection, peer: str) -> None:
        super().connection_made(transport, peer)
        self.server.complaints.log(logging.INFO, "begin", f"the client {self.peer} paces the simulation")

    def data_received(self, data: bytes) -> None:
        if self.is_welcome(data):
            self.is_proven = True
            self._sync.arrived()

    def connection_lost(self, error: OSError | None) -> None:
        super().connection_lost(error)
        self.server.complaints.log(logging.INFO, "end", f"the client {self.peer} no longer paces the simulation")
        self._sync.release()


class SocketStream(KindStream):
    """A stream with its own port.

    Attributes:
        server: the server of the port.
    """

    manager: SocketDatastreamManager
    server: StreamServer


class SocketPublisher(SocketStream):
    """Sends the data of a component as one line of JSON to every client, at each of its actions.

    Subclass it and override `encode` for another format.
    """

    def encode(self) -> Any:
        """The message, or None if there is nothing to send; a line end is added if it is missing."""
        return to_json(self.data)

    def own_form(self) -> Callable[[], object] | None:
        """See `KindStream.own_form`."""
        return None if type(self).encode is SocketPublisher.encode else self.encode

    @property
    def waiting(self) -> Collection[object] | None:
        """The clients."""
        return self.server.readers if type(self).default is KindStream.default else None


class SocketReader(SocketStream):
    """Writes lines of JSON from clients into the data of a component.

    Messages since the last tick are applied in order, so that the last one wins; missing fields
    keep their values. A message that is not JSON, or does not fit the fields of the component, is
    refused as a whole, and the log gives the reason.

    Subclass it and override `decode` for another format.
    """

    @property
    def waiting(self) -> Collection[object] | None:
        """Messages of clients."""
        return self.server.inbox.arrived if type(self).default is KindStream.default else None

    def arrived(self) -> Iterable[bytes]:
        """The lines that have arrived since the last action."""
        if not self.server.inbox or self.rests:
            return ()
        lines, losses = self.server.inbox.take()
        if losses:
            self.complain("dropped", f"{losses} messages arrived too fast: newer messages replace them")
        return lines

    def decode(self, msg: bytes) -> Any:
        """The fields that a message sets.

        Raises:
            ValueError: it cannot be decoded.
        """
        return from_json(msg)


class StreamDirectory(AbstractObject):
    """Names and ports of the streams.

    Args:
        ports: by name of the component.
        binary_port: port of the binary streams.
    """

    def __init__(self, ports: Mapping[str, int], binary_port: int) -> None:
        super().__init__()
        self._ports = ports
        self._binary_port = binary_port

    def name(self) -> str:
        """``simulation``."""
        return "simulation"

    @service(changes=False)
    def list_streams(self) -> list[str]:
        """The names of the components that have a stream."""
        return list(self._ports)

    @service(changes=False)
    def get_stream_port(self, name: str) -> int:
        """The TCP port of the stream of a component."""
        if not isinstance(name, str) or name not in self._ports:
            hint = nearest(str(name), list(self._ports))
            raise MorseRPCInvokationError(f"Stream unavailable for component {short(name)}{hint}")
        return self._ports[name]

    @service(changes=False)
    def get_all_stream_ports(self) -> dict[str, int]:
        """The TCP ports of all streams, by the name of the component."""
        return dict(self._ports)

    @service(changes=False)
    def get_binary_port(self) -> int:
        """The TCP port of the binary streams of all sensors."""
        return self._binary_port


FIRST_PORT = 60000
#: ticks are fast if messages are sent at shorter intervals; messages are then collected for this time, s
_QUICK, _TOGETHER = 0.006, 0.004


class SocketDatastreamManager(DatastreamManager):
    """Streams as lines of JSON, from port 60000 upward.

    A stream with the option ``port`` uses that port. Ports in use are skipped. Binary frames of all sensors
    (`morse.middleware.socket.frames`) are on a separate port.

    Options of ``env.configure_stream_manager('socket', ...)``: with ``time_sync=True``, a client paces
    the simulation (see `TimeSync`) over ``sync_port``, by default 6000.
    """

    classpath = "morse.middleware.socket_datastream.SocketDatastreamManager"
    manager_options = MANAGER_OPTIONS
    by_component = True

    def __init__(self, options: Options, context: Context) -> None:
        super().__init__(options, context)
        self._servers: dict[str, StreamServer] = {}
        self._ports: dict[str, int] = {}
        self._outbox: list[tuple[StreamServer, bytes]] = []
        self._parcels: deque[list[tuple[StreamServer, bytes]]] = deque()
        self._frames: list[tuple[FrameChannel, bytes]] = []
        self._frame_parcels: deque[list[tuple[FrameChannel, bytes]]] = deque()
        self._is_waiting = False
        #: of the last messages that were sent together
        self._number = 0
        self._last_time = 0.0
        self._next_port = FIRST_PORT
        allow_many_sockets()
        self._sync = self._make_sync()
        listener = listen(context.host, [self.options["binary_port"]])
        self._binary_port = port_of(listener)
        self._binary = FrameServer(listener)
        context.network.call(self._binary.start(context.network))
        context.services.register_object("simulation", StreamDirectory(self._ports, self._binary_port))

    def _make_sync(self) -> TimeSync | None:
        if not self.options["time_sync"]:
            return None
        port = self.options["sync_port"]
        sync = TimeSync(self.context, listen(self.context.host, [port]))
        self.context.network.call(sync.start())
        logger.info("a client of port %d may pace the simulation", port)
        return sync

    # -- streams -----------------------------------------------------------------------------

    def make_stream(self, component: Object, declaration: StreamDeclaration) -> SocketStream:
        """See `DatastreamManager.make_stream`.

        Raises:
            MorseMiddlewareError: its class is not a socket stream.
        """
        cls = load_class(declaration.stream)
        if not issubclass(cls, SocketStream):
            raise MorseMiddlewareError(
                f"{declaration.stream} is not a stream of the socket: it has to be a subclass of "
                "morse.middleware.socket_datastream.SocketPublisher or SocketReader"
            )
        stream: SocketStream = super().make_stream(component, declaration)
        return stream

    def opened(self, stream: SocketStream) -> None:
        """Open the port of a stream.

        Raises:
            MorseMiddlewareError: no port is available.
        """
        stream.server = self._server(stream.component_name, stream.kwargs.get("port"))
        if stream.direction == "OUT" and stream.server.binary is None:
            stream.server.binary = self._binary.open(stream.component_name, stream.server.readers)
        if stream.direction == "IN":
            stream.server.reads = True
            stream.server.inbox.clear()  # discard messages to a former component

    def left(self, name: str) -> None:
        """Close the port of a deleted component."""
        server = self._servers.pop(name, None)
        if server is not None:
            del self._ports[name]
            self._outbox[:] = [(to, message) for to, message in self._outbox if to is not server]
            self._frames[:] = [(to, frame) for to, frame in self._frames if to is not server.binary]
            if server.binary is not None:
                self.context.network.post(self._binary.end, server.binary)
            self.context.network.call(server.close())

    def _server(self, name: str, hint: object) -> StreamServer:
        if name in self._servers:
            return self._servers[name]
        first = self._next_port if hint is None else _port(hint, f"the option 'port' of {name}")
        listener = listen(self.context.host, range(first, LAST_PORT + 1) if first else (0,))
        port = port_of(listener)
        if hint is None:
            self._next_port = port + 1
        elif hint not in (0, port):
            logger.warning("%s: port %d is in use, its stream is on port %d", name, hint, port, extra=OF_MACHINE)
        server = StreamServer(name, listener, self._present)
        self.context.network.call(server.start(self.context.network))
        self._servers[name] = server
        self._ports[name] = port
        return server

    def _present(self) -> int | None:
        return None if self._is_awaited() else self.context.clock.tick

    # -- messages ----------------------------------------------------------------------------

    def wanted(self, stream: SocketStream, topic: str) -> bool:
        """Whether a client reads lines, or the binary frames."""
        server, binary = stream.server, stream.server.binary
        return bool(server.connected or (binary is not None and (binary.every or binary.ready)))

    @maps("general")
    def general(self, stream: SocketStream, message: Message) -> Mapping[str, object]:
        """The data of the component, for all other kinds."""
        return message.fields

    @maps("image")
    def image(self, stream: SocketStream, message: Message) -> Mapping[str, object]:
        """The pixels; in base64 in lines."""
        return image_fields(stream.component_instance, message.fields)

    @maps("cloud")
    def cloud(self, stream: SocketStream, message: Message) -> Mapping[str, object]:
        """The points; in base64 in lines."""
        return cloud_fields(stream.component_instance, message.fields)

    def send(self, stream: SocketStream, payload: Any) -> None:
        """Send fields, or the line of a publisher that writes its own, at the end of the tick."""
        server, binary = stream.server, stream.server.binary
        is_line = type(payload) is bytes or type(payload) is str
        line = b""
        if is_line or server.connected:
            line = _line(payload) if is_line or type(payload) is PictureFields else to_json(payload) + b"\n"
        if server.connected:
            self._outbox.append((server, line))
        if binary is not None and (binary.every or binary.ready):
            frame = line_frame(binary.number, line) if is_line else data_frame(binary.number, payload)
            self._frames.append((binary, frame))

    # -- the tick ----------------------------------------------------------------------------

    def action(self) -> None:
        """The beginning of a tick: wait for the client that paces the simulation, if there is one."""
        if self._sync is not None:
            self._sync.wait()

    def flush(self) -> None:
        """The end of a tick: pass all messages to the network thread at once."""
        if self.context.settling:
            self._outbox.clear()
            self._frames.clear()
            return
        if self._outbox:
            self._parcels.append(self._outbox.copy())
            self._outbox.clear()
        elif not self._frames:
            return
        if self._frames:
            self._frame_parcels.append(self._frames.copy())
            self._frames.clear()
        if not self._is_waiting or self._is_awaited():
            self._is_waiting = True
            self.context.network.post(self._send)

    def _send(self) -> None:
        # Ticks may be faster than this thread is scheduled. All pending messages go to each client in one call,
        # which costs less per message. If ticks are fast, the messages of several ticks are sent
        # together: each exchange between the two threads takes longer than a tick
        now = perf_counter()
        quick = now - self._last_time < _QUICK and not self._is_awaited()
        self._last_time = now
        if quick:
            self.context.network.loop.call_later(_TOGETHER, self._send_pending)
        else:
            self._is_waiting = False
        self.push()

    def _is_awaited(self) -> bool:
        """Whether a client waits for the data of this tick before it lets the next one begin."""
        return bool(self.context.paused() or self.context.network.is_awaited)

    def _send_pending(self) -> None:
        if self._parcels or self._frame_parcels:
            self._send()
            return
        self._is_waiting = False
        if self._parcels or self._frame_parcels:  # a tick has ended in the meantime
            self._send()

    def push(self) -> None:
        """See `DatastreamManager.push`; called in the network thread."""
        messages: dict[StreamServer, list[bytes]] = {}
        while self._parcels:
            for server, message in self._parcels.popleft():
                messages.setdefault(server, []).append(message)
        if messages:
            self._number += 1
            publish_together(messages, self._number)
        frames: list[tuple[FrameChannel, bytes]] = []
        while self._frame_parcels:
            frames += self._frame_parcels.popleft()
        if frames:
            self._binary.publish(frames)

    def sent(self) -> dict[str, int]:
        """Number of messages sent to each client of a sensor; called in the network thread.

        The key is its address and the port of the stream: clients of two ports may have the same address.
        """
        self.push()
        ports = [(self._ports[name], server) for name, server in self._servers.items()]
        return {
            f"{client.peer} {port}": client.sent
            for port, server in [*ports, (self._binary_port, self._binary)]
            for client in server.clients
            if client.sent
        }

    def finalize(self) -> None:
        """Send the remaining messages and close."""
        super().finalize()
        self.flush()
        self.context.network.call(self._close())

    async def _close(self) -> None:
        if self._sync is not None:
            await self._sync.close()
        await close_all([*self._servers.values(), self._binary])


def _line(payload: PictureFields | bytes | str) -> bytes:
    if isinstance(payload, PictureFields):
        payload = payload.line()
    line = payload.encode() if isinstance(payload, str) else payload
    return line if line.endswith(b"\n") else line + b"\n"


def _port(value: object, what: str) -> int:
    if isinstance(value, bool) or not isinstance(value, int) or not 0 <= value <= LAST_PORT:
        raise MorseMiddlewareError(f"{what} is a port number from 1 to {LAST_PORT} (0: any free one), not {value!r}")
    return value
