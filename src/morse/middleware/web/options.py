"""Options of middlewares that are reached by WebSocket."""

from __future__ import annotations

from morse.core.declarations import Option
from morse.middleware.ros2.mapping import MANAGER_OPTIONS

LAST_PORT = 65535


def server_options(port: int) -> dict[str, Option]:
    """The options of a server.

    Args:
        port: that it has if the script says no other.
    """
    return {
        "port": Option(int, port, "TCP port; if it is in use, the next free one; 0: any", low=0, high=LAST_PORT),
        "origins": Option(list, [], "pages that may use it besides its own, such as 'http://localhost:8080'"),
        "token": Option(str, None, "what clients have to show in the address (?token=...); made up for other machines"),
        "most_clients": Option(int, 64, "connections at one time", low=1, high=1024),
    }


#: options of ROS 2 that are about what carries its topics
_OF_ROS_2 = ("backend", "domain_id", "interface")
TOPIC_OPTIONS = {name: option for name, option in MANAGER_OPTIONS.items() if name not in _OF_ROS_2}
