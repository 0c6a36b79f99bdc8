"""The shared part of the topics and services of one simulation: a server, and its clients."""

from __future__ import annotations

import weakref
from typing import TYPE_CHECKING, Any, ClassVar

from morse.core.validation.options import checked_options, with_defaults
from morse.middleware.web.client import WebClient
from morse.middleware.web.server import WebServer

if TYPE_CHECKING:
    from collections.abc import Mapping

    from websockets.asyncio.server import ServerConnection

    from morse.core.context import Context
    from morse.core.declarations import Option
    from morse.middleware.web.requests import WebRequestManager
    from morse.middleware.web.topics import WebTopic, WebTopics


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
