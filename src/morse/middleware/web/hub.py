"""What the topics and the services of one simulation share: a server, and its clients."""

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
    """A client that knows its hub."""

    def __init__(self, hub: Hub, connection: ServerConnection) -> None:
        super().__init__(connection)
        self.hub = hub
        #: calls of services that go on
        self.calls = 0

    def show(self, topic: WebTopic, frame: Any) -> None:
        """A message of a topic that the client reads."""
        raise NotImplementedError

    def topic_added(self, topic: WebTopic) -> None:
        """There is a new topic."""

    def topic_removed(self, topic: WebTopic) -> None:
        """A topic is not there any more."""

    def services_changed(self) -> None:
        """Services have come or gone."""

    def tick(self, stamp: int) -> None:
        """Simulated time is now ``stamp`` ns."""

    def answer(self, call: Any, error: str | None, value: bytes) -> None:
        """A call of a service has ended.

        Args:
            call: what the client has given with the call.
            error: why it failed, or None.
            value: the result as JSON; empty if it failed.
        """
        raise NotImplementedError

    def ended(self) -> None:
        """Nothing is sent to it any more."""
        if self.hub.topics is not None:
            for topic in self.hub.topics.offered.values():
                topic.readers.pop(self, None)
        if self.hub.requests is not None:
            self.hub.requests.gone(self)


class Hub:
    """One for each middleware of a simulation.

    Attributes:
        server: see `WebServer`.
        topics: carries data; None if no component of the scene streams data.
        requests: offers services; None if no component of the scene offers them.
    """

    #: name of the middleware
    name: ClassVar[str]
    #: class path of its stream manager, whose options count
    manager: ClassVar[str]
    options: ClassVar[Mapping[str, Option]]
    client: ClassVar[type[HubClient]]
    subprotocols: ClassVar[tuple[str, ...]] = ()

    def __init__(self, context: Context) -> None:
        given = context.scene.manager_options.get(self.manager, {})
        options = with_defaults(self.options, checked_options(self.name, self.options, dict(given)))
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
        """Somebody uses the server; the first one starts it.

        Raises:
            MorseMiddlewareError: no port is free.
        """
        if not self._users:
            self.server.start()
        self._users += 1

    def leave(self) -> None:
        """The last one stops the server."""
        self._users -= 1
        if not self._users:
            self.server.stop()
            _hubs.get(self.context, {}).pop(type(self), None)


_hubs: weakref.WeakKeyDictionary[Context, dict[type[Hub], Hub]] = weakref.WeakKeyDictionary()


def hub_of(context: Context, cls: type[Hub]) -> Hub:
    """The hub of a simulation; it is made when first asked for."""
    hubs = _hubs.setdefault(context, {})
    if cls not in hubs:
        hubs[cls] = cls(context)
    return hubs[cls]
