"""TCP clients: services as lines of text, data streams as lines of JSON."""

from __future__ import annotations

from morse.core.declarations import Option
from morse.middleware.registry import Middleware

SYNC_PORT = 6000
LAST_PORT = 65535

MANAGER_OPTIONS = {
    "time_sync": Option(bool, False, "a client paces the simulation: each tick waits for its bytes"),
    "sync_port": Option(int, SYNC_PORT, "TCP port of that client; 0 for any free one", low=0, high=LAST_PORT),
    "binary_port": Option(int, 0, "TCP port of the binary streams; 0 for any free one", low=0, high=LAST_PORT),
}
STREAM_OPTIONS = {"port": Option(int, None, "TCP port of the stream; 0 for any free one", low=0, high=LAST_PORT)}

MIDDLEWARE = Middleware(
    name="socket",
    stream_manager="morse.middleware.socket_datastream.SocketDatastreamManager",
    request_manager="morse.middleware.socket_request_manager.SocketRequestManager",
    manager_options=MANAGER_OPTIONS,
    stream_options=STREAM_OPTIONS,
    default_publisher="morse.middleware.socket_datastream.SocketPublisher",
    default_reader="morse.middleware.socket_datastream.SocketReader",
    # these classes carry cameras or nothing, and have no data
    not_carried=("StereoUnit", "MocapControl"),
)
