"""Several simulations share one world: each simulates some of its robots, and sends their poses to the others."""

from __future__ import annotations

from morse.core.declarations import Option
from morse.middleware.registry import Middleware

PORT = 65000

MANAGER_OPTIONS = {
    "server_address": Option(str, "localhost", "address of the multi-node server"),
    "server_port": Option(int, PORT, "its TCP port", low=1, high=65535),
}

MIDDLEWARE = Middleware(
    name="multinode",
    stream_manager="morse.plugins.multinode.node.NodeManager",
    manager_options=MANAGER_OPTIONS,
    stream_options={},
    default_publisher=None,
    default_reader=None,
    node_protocols=("socket",),
    purpose="poses of robots between simulations, env.configure_multinode",
)
