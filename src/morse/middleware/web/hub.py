"""A WebSocket server, and what it shares between the topics and services of one simulation."""

from __future__ import annotations

import asyncio
import contextlib
import logging
import socket
import weakref
from http import HTTPStatus
from typing import TYPE_CHECKING, Any, ClassVar, Generic, TypeVar
from urllib.parse import quote

from websockets.exceptions import ConnectionClosed

from morse.core.clients.acceptors import StreamAcceptor
from morse.core.clients.complaints import Complaints
from morse.core.clients.web_access import Access
from morse.core.clients.web_connection import NO_PLACE, place_of, sender_of, serve_on
from morse.core.exceptions import MorseMiddlewareError
from morse.core.validation.fields import checked_options, with_defaults
from morse.middleware.web.client import WebClient
from morse.rosmsgs.topics.manager import TopicManager
from morse.system import OF_MACHINE

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence

    from websockets.asyncio.server import Server, ServerConnection
    from websockets.http11 import Request, Response

    from morse.core.context import Context
    from morse.core.declarations import Option
    from morse.core.values import Options
    from morse.middleware.web.requests import WebRequestManager
    from morse.middleware.web.topics import WebTopic, WebTopics


_C = TypeVar("_C", bound=WebClient)

logger = logging.getLogger(__name__)

MAX_MESSAGE = 1 << 20
"""Maximum size of a message of a client, bytes."""

_TRIES = 10
#: maximum number of connections that have not opened a WebSocket
_UNFINISHED = 64
#: addresses of all networks
_ALL = ("0.0.0.0", "::", "")
#: timeouts for the handshake, for the response to a ping, and for closing, s
_PATIENCE, _SILENCE, _FAREWELL = 20.0, 120.0, 1.0


class WebServer(Generic[_C]):
    """Accepts clients on one port.

    Args:
        context: the simulation.
        name: its name in messages.
        options: see `morse.middleware.web.server_options`.
        make: creates the client of a connection.
        subprotocols: a client has to support one of them; empty for none.

    Attributes:
        clients: the connected clients; changed in the network thread.
        port: the port on which it listens; set by `start`.
        complaints: warnings about clients.
    """

    def __init__(
        self,
        context: Context,
        name: str,
        options: Options,
        make: Callable[[ServerConnection], _C],
        subprotocols: Sequence[str] = (),
    ) -> None:
        self._context, self._name, self._make = context, name, make
        self._subprotocols = list(subprotocols)
        self._first_port, self._most = options["port"], options["most_clients"]
        self._access = Access(
            context.host,
            options["token"],
            name=name,
            elsewhere="start with --host 0.0.0.0",
            origins=_texts(name, options["origins"]),
        )
        self.clients: set[_C] = set()
        self.port = 0
        self.complaints = Complaints(logger)
        most = self._most + _UNFINISHED
        self._acceptor = StreamAcceptor(name, most=most, complaints=self.complaints, refusal=NO_PLACE)
        self._server: Server | None = None
        self._quiet = logging.Logger(
            "morse.middleware.web.connections", logging.CRITICAL + 1
        )  # no log of invalid requests

    def start(self) -> None:
        """Listen.

        Raises:
            MorseMiddlewareError: no port is free.
        """
        self._context.network.call(self._open())
        if self._first_port not in (0, self.port):
            logger.warning(
                "%s: port %d is in use, it is on port %d", self._name, self._first_port, self.port, extra=OF_MACHINE
            )
        logger.info("%s: %s", self._name, self.address)

    def stop(self) -> None:
        """Send the queued messages, and close."""
        self._context.network.call(self._close())

    @property
    def address(self) -> str:
        """The address for clients, with the token if there is one."""
        host = self._context.host
        if host in _ALL:
            host = socket.gethostname()
        name = f"[{host}]" if ":" in host else host
        token = self._access.token
        return f"ws://{name}:{self.port}" + (f"/?token={quote(token, safe='')}" if token else "")

    # -- in the network thread ---------------------------------------------------------------

    async def _open(self) -> None:
        try:
            self._server, self.port = await serve_on(
                self._serve,
                self._context.host,
                _ports(self._first_port),
                self._context.network.arrivals,
                self._acceptor,
                process_request=self._check,
                subprotocols=self._subprotocols or None,
                max_size=MAX_MESSAGE,
                open_timeout=_PATIENCE,
                ping_timeout=_SILENCE,
                close_timeout=_FAREWELL,
                server_header=None,
                logger=self._quiet,
            )
        except OSError as error:
            raise MorseMiddlewareError(
                f"{self._name}: no port from {self._first_port} on is free on {self._context.host}: {error}; "
                f"set another one: env.configure_stream_manager('{self._name}', port=0)"
            ) from None

    async def _close(self) -> None:
        if self._server is None:
            return
        with contextlib.suppress(TimeoutError):
            async with asyncio.timeout(_FAREWELL):
                while any(client.is_behind for client in self.clients):
                    await asyncio.sleep(0.005)
        self._server.close(reason="The simulation has ended")
        try:
            async with asyncio.timeout(_FAREWELL):
                await self._server.wait_closed()
        except TimeoutError:
            for client in self.clients:
                client.connection.transport.abort()

    def _check(self, connection: ServerConnection, request: Request) -> Response | None:
        try:
            refusal = self._access.refusal(request.path, request.headers, secret=True, cookie="")
        except LookupError:
            return connection.respond(HTTPStatus.BAD_REQUEST, "A header that must be unique is repeated.\n")
        if refusal is not None:
            self.complaints.warn("refused", f"{self._name}: {refusal}")
            return connection.respond(HTTPStatus.FORBIDDEN, refusal + "\n")
        if len(self.clients) >= self._most and not self._make_room():
            text = f"{self._name}: there are {self._most} clients already (most_clients)"
            self.complaints.warn("full", text)
            return connection.respond(HTTPStatus.SERVICE_UNAVAILABLE, text + "\n")
        return None

    def _make_room(self) -> bool:
        """Disconnect the oldest client that has not sent a message; False if all have."""
        connections = [(place_of(client.connection), client) for client in self.clients]
        silent = [(place.importance(), place, client) for place, client in connections if not place.keeps_place]
        if not silent:
            return False
        _, place, client = min(silent, key=lambda one: one[0])
        self.complaints.warn("many", f"{self._name}: {client.peer} is disconnected to make room: it sends nothing")
        place.dismiss()
        self.clients.discard(client)
        return True

    async def _serve(self, connection: ServerConnection) -> None:
        client = self._make(connection)
        self.clients.add(client)
        sender = asyncio.create_task(client.send_forever())
        try:
            client.begin()
            await client.receive_forever(sender_of(connection))
        except ConnectionClosed:
            pass  # a client may disconnect at any time
        except Exception as error:  # an error of one client must not affect the others
            self.complaints.warn("failed", f"{self._name}: {client.peer}: {type(error).__name__}: {error}")
        finally:
            sender.cancel()
            self.clients.discard(client)
            client.ended()

    def complain(self, client: WebClient, kind: str, text: str) -> None:
        """Log an error of a client."""
        self.complaints.warn(kind, f"{self._name}: {client.peer}: {text}")


def _ports(first: int) -> Iterator[int]:
    yield from range(first, min(first + _TRIES, 65536)) if first else (0,)


def _texts(name: str, values: Sequence[Any]) -> list[str]:
    wrong = [one for one in values if not (isinstance(one, str) and "://" in one)]
    if wrong:
        raise MorseMiddlewareError(
            f"{name}: the option 'origins' has {wrong[0]!r:.80}, expected addresses such as 'http://localhost:8080'"
        )
    return list(values)


class HubClient(WebClient):
    """A client with a reference to its hub."""

    def __init__(self, hub: Hub, connection: ServerConnection) -> None:
        super().__init__(connection)
        self.hub = hub
        #: active service calls
        self.calls = 0

    def show(self, topic: WebTopic, frame: object) -> None:
        """A message of a topic to which the client has subscribed."""
        raise NotImplementedError

    def topic_added(self, topic: WebTopic) -> None:
        """A topic was added."""

    def topic_removed(self, topic: WebTopic) -> None:
        """A topic was removed."""

    def services_changed(self) -> None:
        """Services were added or removed."""

    def tick(self, stamp: int) -> None:
        """Simulated time is now ``stamp`` ns."""

    def answer(self, call: object, error: str | None, value: bytes) -> None:
        """A call of a service has ended.

        Args:
            call: the value that the client passed with the call.
            error: why it failed, or None.
            value: the result as JSON; empty if it failed.
        """
        raise NotImplementedError

    def ended(self) -> None:
        """The connection is closed: send nothing more."""
        if self.hub.topics is not None:
            for topic in self.hub.topics.offered.values():
                topic.readers.pop(self, None)
        if self.hub.requests is not None:
            self.hub.requests.gone(self)


class Hub:
    """There is one hub for each WebSocket middleware of a simulation.

    Attributes:
        server: see `WebServer`.
        topics: the topics; None if no component of the scene streams data.
        requests: the services; None if no component of the scene offers services.
    """

    #: name of the middleware
    name: ClassVar[str]
    #: class path of its stream manager, whose options apply
    manager: ClassVar[str]
    options: ClassVar[Mapping[str, Option]]
    client: ClassVar[type[HubClient]]
    subprotocols: ClassVar[tuple[str, ...]] = ()

    def __init__(self, context: Context) -> None:
        settings = context.scene.manager_options.get(self.manager, {})
        options = with_defaults(self.options, checked_options(self.name, self.options, dict(settings)))
        self.context = context
        self.server: WebServer[HubClient] = WebServer(context, self.name, options, self._welcome, self.subprotocols)
        self.topics: WebTopics | None = None
        self.requests: WebRequestManager | None = None
        self._users = 0

    def _welcome(self, connection: ServerConnection) -> HubClient:
        return self.client(self, connection)

    def frame(self, topic: WebTopic, stamp: int, data: bytes) -> Any:
        """The part of a message that is the same for all clients; in the network thread."""
        raise NotImplementedError

    def join(self) -> None:
        """Add a user of the server; the first user starts it.

        Raises:
            MorseMiddlewareError: no port is free.
        """
        if not self._users:
            self.server.start()
        self._users += 1

    def leave(self) -> None:
        """Remove a user; the last one stops the server."""
        self._users -= 1
        if not self._users:
            self.server.stop()
            _hubs.get(self.context, {}).pop(type(self), None)


_hubs: weakref.WeakKeyDictionary[Context, dict[type[Hub], Hub]] = weakref.WeakKeyDictionary()


def hub_of(context: Context, cls: type[Hub]) -> Hub:
    """The hub of a simulation; created on first use."""
    hubs = _hubs.setdefault(context, {})
    if cls not in hubs:
        hubs[cls] = cls(context)
    return hubs[cls]


class WebTopicManager(TopicManager):
    """Publishes topics on the server that the simulation has for a middleware.

    Attributes:
        hub_class: the server and its clients.
        topics_class: the topics.
    """

    hub_class: ClassVar[type[Hub]]
    topics_class: ClassVar[type[WebTopics]]
    backend: WebTopics

    def _make_backend(self) -> WebTopics:
        return self.topics_class(hub_of(self.context, self.hub_class))

    def flush(self) -> None:
        """The end of a tick: publish time and frames, and send all messages."""
        super().flush()
        self.backend.flush()
