"""Publishes data streams to Foxglove."""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING, Any

import msgspec

from morse.core.services import signature_of
from morse.middleware.foxglove import MANAGER_OPTIONS, graph
from morse.middleware.foxglove.client import FoxgloveClient
from morse.middleware.foxglove.parameters import GET, SET, Parameters
from morse.middleware.rosbridge.forms import decode_json
from morse.middleware.web.hub import Hub, WebTopicManager
from morse.middleware.web.requests import WebRequestManager, encoded
from morse.middleware.web.topics import WebTopics

if TYPE_CHECKING:
    from morse.core.context import Context
    from morse.core.values import RosMessage
    from morse.middleware.web.hub import HubClient
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


class FoxgloveTopics(WebTopics):
    """Topics whose messages are CDR; clients may also send JSON."""

    def decode(self, type_name: str, data: bytes) -> RosMessage:
        """See `morse.rosmsgs.topics.backend.Backend.decode`."""
        # the first byte of CDR is 0, that of JSON never
        if data[:1] == b"\0":
            return super().decode(type_name, data)
        return decode_json(type_name, data)


class FoxgloveDatastreamManager(WebTopicManager):
    """The topics, messages and frames of ROS 2, for Foxglove.

    Options of ``env.configure_stream_manager('foxglove', ...)`` are in `morse.middleware.foxglove`.
    """

    classpath = "morse.middleware.foxglove.datastream.FoxgloveDatastreamManager"
    manager_options = MANAGER_OPTIONS
    title = "foxglove"
    hub_class = FoxgloveHub
    topics_class = FoxgloveTopics


#: ticks between two looks at the parameters that clients watch
_PERIOD = 15


class FoxgloveRequestManager(WebRequestManager):
    """Services with arguments and results in JSON; the properties of components as parameters."""

    classpath = "morse.middleware.foxglove.datastream.FoxgloveRequestManager"
    hub_class = FoxgloveHub

    def __init__(self, context: Context) -> None:
        super().__init__(context)
        self._parameters = Parameters(context, self._settable, self._set)
        self._ticks = 0

    def _settable(self) -> list[str]:
        return [component for component, name in self._services if name == "set_property"]

    def _set(self, component: str, arguments: list[object]) -> None:
        self.on_incoming_request(component, "set_property", arguments)

    def _handle(self, client: HubClient, call: object, path: str, arguments: bytes) -> None:
        if path not in (GET, SET):
            super()._handle(client, call, path, arguments)
            return
        fields = msgspec.json.decode(arguments)
        try:
            names, refusals = (fields, []) if path == GET else self._parameters.write(fields)
            values = self._parameters.read(names) if names or path == GET else []
            self._outbox.append((client, call, None, encoded({"parameters": values, "refusals": refusals})))
        except Exception as error:  # a property may be code of the user
            text = self._complaints.service_failed("a parameter", error)
            self._outbox.append((client, call, text, b""))

    def main(self) -> None:
        """See `RequestManager.main`; also tell which watched parameters have changed."""
        super().main()
        self._ticks += 1
        if self._ticks % _PERIOD == 0:
            for client in list(self._hub.server.clients):
                names = client.watched  # type: ignore[attr-defined] # it is a FoxgloveClient
                if names:
                    self._tell(client, names)

    def _tell(self, client: Any, names: frozenset[str]) -> None:
        try:
            values = encoded([one for one in self._parameters.read(()) if one["name"] in names])
        except Exception as error:  # a property may be code of the user
            self._complaints.service_failed("a parameter", error)
        else:
            self._context.network.post(client.watch, values)
