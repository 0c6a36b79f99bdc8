"""Publishes data streams to clients of rosbridge."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.middleware.rosbridge import MANAGER_OPTIONS
from morse.middleware.rosbridge.client import RosbridgeClient
from morse.middleware.rosbridge.forms import Forms, decode_json
from morse.middleware.web.hub import Hub, WebTopicManager
from morse.middleware.web.requests import WebRequestManager
from morse.middleware.web.topics import WebTopics

if TYPE_CHECKING:
    from morse.core.values import RosMessage
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


class RosbridgeTopics(WebTopics):
    """Topics with messages in CDR, and commands in JSON."""

    def decode(self, type_name: str, data: bytes) -> RosMessage:
        """See `morse.rosmsgs.topics.backend.Backend.decode`."""
        return decode_json(type_name, data)


class RosbridgeDatastreamManager(WebTopicManager):
    """The topics, messages and frames of ROS 2, as JSON over WebSocket.

    Options of ``env.configure_stream_manager('rosbridge', ...)`` are in `morse.middleware.rosbridge`.
    """

    classpath = "morse.middleware.rosbridge.datastream.RosbridgeDatastreamManager"
    manager_options = MANAGER_OPTIONS
    title = "rosbridge"
    hub_class = RosbridgeHub
    topics_class = RosbridgeTopics


class RosbridgeRequestManager(WebRequestManager):
    """Services for the operation ``call_service``."""

    classpath = "morse.middleware.rosbridge.datastream.RosbridgeRequestManager"
    hub_class = RosbridgeHub
