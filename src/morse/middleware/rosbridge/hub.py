"""The server of rosbridge, and the format of its messages."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.middleware.rosbridge import MANAGER_OPTIONS
from morse.middleware.rosbridge.client import RosbridgeClient
from morse.middleware.rosbridge.forms import Forms
from morse.middleware.web.hub import Hub

if TYPE_CHECKING:
    from morse.middleware.web.topics import WebTopic


class RosbridgeHub(Hub):
    """See `morse.middleware.web.hub.Hub`."""

    name = "rosbridge"
    manager = "morse.middleware.rosbridge.datastream.RosbridgeDatastreamManager"
    options = MANAGER_OPTIONS
    client = RosbridgeClient

    def frame(self, topic: WebTopic, stamp: int, data: bytes) -> Forms:
        """The operation ``publish``."""
        return Forms(topic, stamp, data)
