"""Publishes data streams to clients of rosbridge."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.middleware.rosbridge import MANAGER_OPTIONS, json_form
from morse.middleware.rosbridge.hub import RosbridgeHub
from morse.middleware.web.datastream import WebTopicManager
from morse.middleware.web.topics import WebTopics

if TYPE_CHECKING:
    from morse.core.values import RosMessage


class RosbridgeTopics(WebTopics):
    """Topics with messages in CDR, and commands in JSON."""

    def decode(self, type_name: str, data: bytes) -> RosMessage:
        """See `morse.rosmsgs.topics.backend.Backend.decode`."""
        return json_form.decode(type_name, data)


class RosbridgeDatastreamManager(WebTopicManager):
    """The topics, messages and frames of ROS 2, as JSON over WebSocket.

    Options of ``env.configure_stream_manager('rosbridge', ...)`` are in `morse.middleware.rosbridge`.
    """

    classpath = "morse.middleware.rosbridge.datastream.RosbridgeDatastreamManager"
    manager_options = MANAGER_OPTIONS
    title = "rosbridge"
    hub_class = RosbridgeHub
    topics_class = RosbridgeTopics
