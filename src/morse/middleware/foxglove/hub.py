"""The server of Foxglove, and the format of its messages."""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING

from morse.core.services import signature_of
from morse.middleware.foxglove import MANAGER_OPTIONS, graph
from morse.middleware.foxglove.client import FoxgloveClient
from morse.middleware.web.hub import Hub

if TYPE_CHECKING:
    from morse.core.context import Context
    from morse.core.values import RosMessage
    from morse.middleware.web.topics import WebTopic
    from morse.scene.articulation import Articulation


class FoxgloveHub(Hub):
    """See `morse.middleware.web.hub.Hub`."""

    name = "foxglove"
    manager = "morse.middleware.foxglove.datastream.FoxgloveDatastreamManager"
    options = MANAGER_OPTIONS
    client = FoxgloveClient
    subprotocols = ("foxglove.sdk.v1", "foxglove.websocket.v1")

    def __init__(self, context: Context) -> None:
        super().__init__(context)
        self._numbers = itertools.count(1)
        self._of_path: dict[str, int] = {}
        self._graph_is_told = True

    def frame(self, topic: WebTopic, stamp: int, data: bytes) -> bytes:
        """The part of a message after the id of the subscription: the time, ns, and the data."""
        return max(0, stamp).to_bytes(8, "little") + data

    def services(self) -> dict[int, str]:
        """The names of the services by id; the id of a service does not change. In the network thread."""
        paths = self.requests.paths if self.requests is not None else {}
        for path in paths:
            if path not in self._of_path:
                self._of_path[path] = next(self._numbers)
        return {self._of_path[path]: path for path in paths}

    def graph_changed(self) -> None:
        """Tell the clients that want the connection graph, once for all changes until then. In the network thread."""
        if self._graph_is_told and any(client.shows_graph for client in self.server.clients):  # type: ignore[attr-defined]
            self._graph_is_told = False
            self.context.network.loop.call_soon(self._tell_graph)

    def _tell_graph(self) -> None:
        self._graph_is_told = True
        now = graph.graph_of(self)
        for client in list(self.server.clients):
            client.tell_graph(now)  # type: ignore[attr-defined] # it is a FoxgloveClient

    def descriptions(self) -> list[Articulation]:
        """The descriptions of the robots; in any thread."""
        robots = [robot.bge_object for robot in list(self.context.robots.values())]
        return [body.node.articulation for body in robots if body.node.articulation is not None]

    def arguments_of(self, path: str) -> RosMessage:
        """The arguments of a service as JSON schema."""
        service = None
        if self.requests is not None and path in self.requests.paths:
            service = self.requests.find(*self.requests.paths[path])
        parameters = signature_of(service.callback).parameters if service is not None else {}
        missing = [
            name for name, one in parameters.items() if one.default is one.empty and one.kind < one.VAR_POSITIONAL
        ]
        return {"type": "object", "properties": {name: {} for name in parameters}, "required": missing}
