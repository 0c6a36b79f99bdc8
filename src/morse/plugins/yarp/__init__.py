"""The data and the services of components on ports of YARP, by a protocol implementation of our own."""

from __future__ import annotations

from dataclasses import replace

from morse.core.declarations import Option
from morse.middleware.registry import Middleware

PORT = 10000

MANAGER_OPTIONS = {
    "host": Option(str, "127.0.0.1", "name or address of the name server, yarpserver"),
    "port": Option(int, PORT, "port of the name server", low=1, high=65535),
    "prefix": Option(str, "morse", "first word of the names of all ports"),
}
STREAM_OPTIONS = {
    "port": Option(str, None, "name of the port, replaces /prefix/robot/component/out or in"),
}
STREAM_MANAGER = "morse.middleware.yarp_datastream.YarpDatastreamManager"
JSON_STREAM_MANAGER = "morse.plugins.yarp.datastream.YarpJsonDatastreamManager"
REQUEST_MANAGER = "morse.middleware.yarp_request_manager.YarpRequestManager"
# these classes carry cameras or nothing, or clouds, for which 1.4 had no port
NOT_CARRIED = ("DepthCamera", "DepthCameraAggregator", "StereoUnit", "MocapControl")

MIDDLEWARE = Middleware(
    name="yarp",
    stream_manager=STREAM_MANAGER,
    request_manager=REQUEST_MANAGER,
    manager_options=MANAGER_OPTIONS,
    stream_options=STREAM_OPTIONS,
    default_publisher="morse.plugins.yarp.datastream.YarpPublisher",
    default_reader="morse.plugins.yarp.datastream.YarpReader",
    not_carried=NOT_CARRIED,
    purpose="ports of YARP, with a name server",
)
JSON_MIDDLEWARE = replace(
    MIDDLEWARE,
    name="yarp_json",
    stream_manager=JSON_STREAM_MANAGER,
    default_publisher="morse.plugins.yarp.datastream.YarpJsonPublisher",
    default_reader="morse.plugins.yarp.datastream.YarpJsonReader",
    # megabytes of text in each tick
    not_carried=(*NOT_CARRIED, "Camera", "CameraUnit"),
    purpose="ports of YARP with JSON texts",
)
