"""The base class of stream managers whose topics go to the clients of a WebSocket server."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

from morse.middleware.web.hub import hub_of
from morse.rosmsgs.topics.manager import TopicManager

if TYPE_CHECKING:
    from morse.middleware.web.hub import Hub
    from morse.middleware.web.topics import WebTopics


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
