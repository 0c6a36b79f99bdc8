"""The mapping of YARP with JSON."""

from __future__ import annotations

from morse.middleware.registry import Middleware
from morse.middleware.yarp.mapping import (
    JSON_STREAM_MANAGER,
    MANAGER_OPTIONS,
    NOT_CARRIED,
    REQUEST_MANAGER,
    STREAM_OPTIONS,
)

MIDDLEWARE = Middleware(
    name="yarp_json",
    stream_manager=JSON_STREAM_MANAGER,
    request_manager=REQUEST_MANAGER,
    manager_options=MANAGER_OPTIONS,
    stream_options=STREAM_OPTIONS,
    default_publisher="morse.middleware.yarp_json.streams.YarpJsonPublisher",
    default_reader="morse.middleware.yarp_json.streams.YarpJsonReader",
    # megabytes of text in each tick
    not_carried=(*NOT_CARRIED, "Camera", "CameraUnit"),
)
