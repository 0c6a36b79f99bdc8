"""Publishes data streams to Foxglove."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.middleware.foxglove import MANAGER_OPTIONS
from morse.middleware.foxglove.hub import FoxgloveHub
from morse.middleware.rosbridge import json_form
from morse.middleware.web.datastream import WebTopicManager
from morse.middleware.web.topics import WebTopics

if TYPE_CHECKING:
    from morse.core.values import RosMessage


class FoxgloveTopics(WebTopics):
    """Topics whose messages are CDR; clients may also send JSON."""

    def decode(self, type_name: str, data: bytes) -> RosMessage:
        """See `morse.rosmsgs.topics.backend.Backend.decode`."""
        # the first byte of CDR is 0, that of JSON never
        if data[:1] == b"\0":
            return super().decode(type_name, data)
        return json_form.decode(type_name, data)


class FoxgloveDatastreamManager(WebTopicManager):
    """The topics, messages and frames of ROS 2, for Foxglove.

    Options of ``env.configure_stream_manager('foxglove', ...)`` are in `morse.middleware.foxglove`.
    """

    classpath = "morse.middleware.foxglove.datastream.FoxgloveDatastreamManager"
    manager_options = MANAGER_OPTIONS
    title = "foxglove"
    hub_class = FoxgloveHub
    topics_class = FoxgloveTopics
