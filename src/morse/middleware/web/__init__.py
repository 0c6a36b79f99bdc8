"""Common parts of the WebSocket middlewares."""

from __future__ import annotations

from morse.core.declarations import Option
from morse.middleware.ros2 import MANAGER_OPTIONS

LAST_PORT = 65535


def server_options(port: int) -> dict[str, Option]:
    """The options of a server.

    Args:
        port: the default port.
    """
    return {
        "port": Option(int, port, "TCP port; if it is in use, the next free one; 0: any", low=0, high=LAST_PORT),
        "origins": Option(list, [], "origins of web pages that may connect, such as 'http://localhost:8080'"),
        "token": Option(str, None, "token of clients in the address (?token=...); generated for other machines"),
        "most_clients": Option(int, 64, "maximum number of connections", low=1, high=1024),
    }


#: options of ROS 2 that only concern the transport of its topics
_OF_ROS_2 = ("backend", "domain_id", "interface", "diagnostics")
TOPIC_OPTIONS = {name: option for name, option in MANAGER_OPTIONS.items() if name not in _OF_ROS_2}
