"""One client of Foxglove."""

from __future__ import annotations

import uuid
from typing import TYPE_CHECKING, Any, NamedTuple

import msgspec

from morse.core.reports.quoting import nearest, short, shown
from morse.middleware.foxglove import frames, graph
from morse.middleware.foxglove.assets import Assets
from morse.middleware.foxglove.parameters import GET, SET
from morse.middleware.web.hub import HubClient
from morse.rosmsgs.definitions import definition

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from websockets.asyncio.server import ServerConnection

    from morse.core.values import JsonObject
    from morse.middleware.web.topics import WebTopic

_ENCODINGS = ("cdr", "json")
_CAPABILITIES = (
    *("clientPublish", "services", "time"),
    *("parameters", "parametersSubscribe", "connectionGraph", "assets"),
)
_ERROR = 2
_LARGEST = 2**32 - 1
#: bytes that are counted for the name of a topic
_LONGEST_TOPIC = 256


#: operations that change who reads and publishes what
_CHANGE_GRAPH = ("subscribe", "unsubscribe", "advertise", "unadvertise")


class _Asked(NamedTuple):
    """A request for parameters; the answer contains the id, and is sent if it is to be told."""

    id: dict[str, str]
    told: bool


class FoxgloveClient(HubClient):
    """Implements ``foxglove.websocket.v1`` and ``foxglove.sdk.v1``, which are identical in the parts used here."""

    def __init__(self, hub: Any, connection: ServerConnection) -> None:
        super().__init__(hub, connection)
        #: id of a subscription to its topic
        self._subscriptions: dict[int, WebTopic] = {}
        #: id of a channel of the client to its topic
        self._channels: dict[int, str] = {}
        self._services: frozenset[int] = frozenset()
        #: names of parameters whose changes are told; replaced, never modified: the simulation thread reads it
        self.watched: frozenset[str] = frozenset()
        self._watched_values: dict[str, bytes] = {}
        #: the connection graph as the client knows it; None while it has not asked for it
        self._graph: Mapping[str, graph.Table] | None = None
        self._assets = Assets(self)

    def begin(self) -> None:
        """See `WebClient.begin`."""
        self._say(
            op="serverInfo",
            name="MORSE",
            capabilities=list(_CAPABILITIES),
            supportedEncodings=list(_ENCODINGS),
            metadata={},
            sessionId=str(uuid.uuid4()),
        )
        if self.hub.topics is not None and self.hub.topics.offered:
            self._advertise_topics(list(self.hub.topics.offered.values()))
        self.services_changed()

    def _say(self, **message: object) -> None:
        self.tell(msgspec.json.encode(message).decode())

    def _status(self, level: int, text: str) -> None:
        self._say(op="status", level=level, message=text)

    # -- topics ------------------------------------------------------------------------------

    def _advertise_topics(self, topics: list[WebTopic]) -> None:
        channels = [
            {
                "id": topic.number,
                "topic": topic.topic,
                "encoding": "cdr",
                "schemaName": topic.type,
                "schemaEncoding": "ros2msg",
                "schema": definition(topic.type),
            }
            for topic in topics
        ]
        self._say(op="advertise", channels=channels)

    def topic_added(self, topic: WebTopic) -> None:
        """See `HubClient.topic_added`."""
        self._advertise_topics([topic])
        self.hub.graph_changed()  # type: ignore[attr-defined] # it is a FoxgloveHub

    def topic_removed(self, topic: WebTopic) -> None:
        """See `HubClient.topic_removed`."""
        for number in [number for number, one in self._subscriptions.items() if one is topic]:
            del self._subscriptions[number]
            self.release(0)
        self._say(op="unadvertise", channelIds=[topic.number])
        self.hub.graph_changed()  # type: ignore[attr-defined] # it is a FoxgloveHub

    def show(self, topic: WebTopic, frame: Any) -> None:
        """See `HubClient.show`."""
        is_queued = self.offer(topic.number, frames.message(topic.readers[self], frame), topic.qos.depth)
        if not is_queued and topic.qos.reliable:
            self.hub.server.complain(self, f"slow {self.peer}", f"reads {topic.topic} too slowly, it misses messages")

    def tick(self, stamp: int) -> None:
        """See `HubClient.tick`."""
        self.offer("time", frames.time(stamp), 1)

    def _subscribe(self, message: JsonObject) -> None:
        topics = self.hub.topics.offered.values() if self.hub.topics is not None else ()
        by_number = {topic.number: topic for topic in topics}
        for one in _records(message, "subscriptions"):
            number, channel = _number(one, "id"), _number(one, "channelId")
            topic = by_number.get(channel)
            if topic is None:
                raise ValueError(f"there is no channel {channel}")
            if number in self._subscriptions or self in topic.readers:
                raise ValueError(f"{topic.topic} is subscribed already, or the subscription {number} is in use")
            self.keep(0, "a subscription")
            self._subscriptions[number] = topic
            topic.readers[self] = number
            for stamp, data in tuple(topic.kept):
                self.show(topic, self.hub.frame(topic, stamp, data))

    def _unsubscribe(self, message: JsonObject) -> None:
        for number in _numbers(message, "subscriptionIds"):
            topic = self._subscriptions.pop(number, None)
            if topic is None:
                raise ValueError(f"there is no subscription {number}")
            self.release(0)
            topic.readers.pop(self, None)

    # -- messages of the client --------------------------------------------------------------

    def _advertise(self, message: JsonObject) -> None:
        subscriptions = self.hub.topics.heard if self.hub.topics is not None else {}
        for one in _records(message, "channels"):
            number, topic, kind = _number(one, "id"), one.get("topic"), one.get("schemaName")
            if not isinstance(topic, str) or topic not in subscriptions:
                raise ValueError(f"no component subscribes to {short(topic)}{nearest(str(topic)[:256], subscriptions)}")
            if one.get("encoding") not in _ENCODINGS:
                raise ValueError(f"the encoding {shown(one.get('encoding'))} is none of {', '.join(_ENCODINGS)}")
            if isinstance(kind, str) and kind and _of_ros_2(kind) != subscriptions[topic].type:
                raise ValueError(f"the topic {topic} has the type {subscriptions[topic].type}, not {short(kind)}")
            if number not in self._channels:
                self.keep(_LONGEST_TOPIC, "a channel")
            self._channels[number] = topic

    def _unadvertise(self, message: JsonObject) -> None:
        for number in _numbers(message, "channelIds"):
            if self._channels.pop(number, None) is not None:
                self.release(_LONGEST_TOPIC)

    def _publish(self, request: frames.Published) -> None:
        topic = self._channels.get(request.channel)
        if topic is None:
            raise ValueError(f"the channel {request.channel} was not advertised")
        subscription = self.hub.topics.heard.get(topic) if self.hub.topics is not None else None
        for inlet in subscription.inlets if subscription is not None else ():
            inlet.put(request.data)

    # -- services ----------------------------------------------------------------------------

    def services_changed(self) -> None:
        """See `HubClient.services_changed`."""
        services = self.hub.services()  # type: ignore[attr-defined] # it is a FoxgloveHub
        removals = sorted(self._services - services.keys())
        new = sorted(services.keys() - self._services)
        self._services = frozenset(services)
        if removals:
            self._say(op="unadvertiseServices", serviceIds=removals)
        if new:
            self._say(op="advertiseServices", services=[self._service(number, services[number]) for number in new])
        self.hub.graph_changed()  # type: ignore[attr-defined] # it is a FoxgloveHub

    def _service(self, number: int, path: str) -> JsonObject:
        request = self.hub.arguments_of(path)  # type: ignore[attr-defined] # it is a FoxgloveHub
        return {
            "id": number,
            "name": path,
            "type": f"morse{path}",
            "request": _schema(f"morse{path}_Request", request),
            "response": _schema(f"morse{path}_Response", {"type": "object"}),
        }

    def _call(self, call: frames.Call) -> None:
        number = (call.service, call.call)
        path = self.hub.services().get(call.service)  # type: ignore[attr-defined] # it is a FoxgloveHub
        if path is None or self.hub.requests is None:
            self.answer(number, f"there is no service {call.service}", b"")
        elif call.encoding != "json":
            self.answer(number, f"arguments have to be JSON, not {short(call.encoding)}", b"")
        else:
            self.hub.requests.call(self, number, path, call.data)

    def answer(self, call: Any, error: str | None, value: bytes) -> None:
        """See `HubClient.answer`."""
        if isinstance(call, _Asked):
            self._answer_parameters(call, error, value)
            return
        service, number = call
        if error is not None:
            self._say(op="serviceCallFailure", serviceId=service, callId=number, message=error)
        else:
            data = value if value.startswith(b"{") else b'{"result":' + value + b"}"
            self.tell(frames.answer(service, number, "json", data))

    # -- parameters --------------------------------------------------------------------------

    def _get_parameters(self, message: JsonObject) -> None:
        self._ask(GET, _Asked(_id(message), told=True), _names(message))

    def _set_parameters(self, message: JsonObject) -> None:
        # an answer is due if the client has given an id
        self._ask(SET, _Asked(_id(message), told="id" in message), _records(message, "parameters"))

    def _ask(self, what: str, call: _Asked, values: list[Any]) -> None:
        if self.hub.requests is None:
            self._say(op="parameterValues", parameters=[], **call.id)
            return
        self.hub.requests.call(self, call, what, msgspec.json.encode(values))

    def _answer_parameters(self, call: _Asked, error: str | None, value: bytes) -> None:
        if error is not None:
            self._status(_ERROR, error)
            return
        answer = msgspec.json.decode(value)
        for refusal in answer["refusals"]:
            self._status(_ERROR, refusal)
        if call.told:
            self._say(op="parameterValues", parameters=answer["parameters"], **call.id)

    def _watch_more(self, message: JsonObject) -> None:
        more = set[str]()
        try:
            for name in set(_names(message)) - self.watched:
                self.keep(_LONGEST_TOPIC + len(name), "a watched parameter")
                more.add(name)
        finally:
            self.watched |= more

    def _watch_less(self, message: JsonObject) -> None:
        less = self.watched & set(_names(message))
        self.watched -= less
        for name in less:
            self.release(_LONGEST_TOPIC + len(name))
            self._watched_values.pop(name, None)

    def watch(self, values: bytes) -> None:
        """The present values of watched parameters, as JSON: tell the client those that have changed."""
        changes = []
        for one in msgspec.json.decode(values):
            name, value = one["name"], msgspec.json.encode(one)
            if name in self.watched and self._watched_values.get(name) != value:
                self._watched_values[name] = value
                changes.append(one)
        if changes:
            self._say(op="parameterValues", parameters=changes)

    # -- the connection graph ----------------------------------------------------------------

    def published(self) -> set[str]:
        """The topics on which this client publishes."""
        return set(self._channels.values())

    def _show_graph(self, message: JsonObject) -> None:
        if self._graph is not None:
            raise ValueError("the connection graph is subscribed already")
        self._graph = graph.EMPTY
        self.tell_graph(graph.graph_of(self.hub))

    def _hide_graph(self, message: JsonObject) -> None:
        if self._graph is None:
            raise ValueError("the connection graph is not subscribed")
        self._graph = None

    @property
    def shows_graph(self) -> bool:
        """Whether the client wants changes of the connection graph."""
        return self._graph is not None

    def tell_graph(self, now: Mapping[str, graph.Table]) -> None:
        """Tell what has changed in the connection graph; nothing if the client has not asked for it."""
        if self._graph is not None:
            change = graph.update(self._graph, now)
            if change is not None or self._graph is graph.EMPTY:
                self._say(op="connectionGraphUpdate", **(change or graph.NOTHING))
            self._graph = now

    # -- assets ------------------------------------------------------------------------------

    def _fetch(self, message: JsonObject) -> None:
        uri, number = message.get("uri"), _number(message, "requestId")
        if not isinstance(uri, str):
            raise ValueError(f"'uri' is {shown(uri)}, expected a text")
        self._assets.fetch(uri, number, self.hub.descriptions())  # type: ignore[attr-defined] # it is a FoxgloveHub

    def ended(self) -> None:
        """See `WebClient.ended`."""
        super().ended()
        self._assets.close()
        self.hub.graph_changed()  # type: ignore[attr-defined] # it is a FoxgloveHub

    # -- received messages -------------------------------------------------------------------

    def received(self, frame: str | bytes) -> None:
        """See `WebClient.received`."""
        try:
            if isinstance(frame, str):
                self._operate(frame)
            else:
                content = frames.parse(frame)
                if isinstance(content, frames.Call):
                    self._call(content)
                else:
                    self._publish(content)
        except ValueError as error:
            self.hub.server.complain(self, "refused", str(error))
            self._status(_ERROR, str(error))

    def _operate(self, frame: str) -> None:
        try:
            message = msgspec.json.decode(frame)
        except (msgspec.DecodeError, RecursionError, UnicodeDecodeError, UnicodeEncodeError) as error:
            raise ValueError(f"not JSON: {error}") from None
        operations: dict[str, Callable[[JsonObject], None]] = {
            "subscribe": self._subscribe,
            "unsubscribe": self._unsubscribe,
            "advertise": self._advertise,
            "unadvertise": self._unadvertise,
            GET: self._get_parameters,
            SET: self._set_parameters,
            "subscribeParameterUpdates": self._watch_more,
            "unsubscribeParameterUpdates": self._watch_less,
            "subscribeConnectionGraph": self._show_graph,
            "unsubscribeConnectionGraph": self._hide_graph,
            "fetchAsset": self._fetch,
        }
        name = message.get("op") if isinstance(message, dict) else None
        if not isinstance(name, str) or name not in operations:
            raise ValueError(f"the operation {shown(name)} is not supported{nearest(str(name)[:64], operations)}")
        operations[name](message)
        if name in _CHANGE_GRAPH:
            self.hub.graph_changed()  # type: ignore[attr-defined] # it is a FoxgloveHub


def _schema(name: str, schema: JsonObject) -> dict[str, str]:
    text = msgspec.json.encode(schema).decode()
    return {"encoding": "json", "schemaName": name, "schemaEncoding": "jsonschema", "schema": text}


def _records(message: JsonObject, name: str) -> list[JsonObject]:
    value = message.get(name)
    if not isinstance(value, list) or not all(isinstance(one, dict) for one in value):
        raise ValueError(f"'{name}' is {shown(value)}, expected a list of objects")
    return value


def _names(message: JsonObject) -> list[str]:
    value = message.get("parameterNames")
    if not isinstance(value, list) or not all(isinstance(one, str) for one in value):
        raise ValueError(f"'parameterNames' is {shown(value)}, expected a list of texts")
    return value


def _id(message: JsonObject) -> dict[str, str]:
    """The id of a request, as it is returned; empty if it has none."""
    value = message.get("id")
    if value is not None and not isinstance(value, str):
        raise ValueError(f"'id' is {shown(value)}, expected a text")
    return {} if value is None else {"id": value}


def _numbers(message: JsonObject, name: str) -> list[int]:
    value = message.get(name)
    if not isinstance(value, list):
        raise ValueError(f"'{name}' is {shown(value)}, expected a list of numbers")
    return [_number({"item": one}, "item") for one in value]


def _number(record: JsonObject, name: str) -> int:
    value = record.get(name)
    if isinstance(value, bool) or not isinstance(value, int) or not 0 <= value <= _LARGEST:
        raise ValueError(f"'{name}' is {shown(value)}, expected a number from 0 to {_LARGEST}")
    return value


def _of_ros_2(name: str) -> str:
    """Convert ``std_msgs/String`` of ROS 1 to ``std_msgs/msg/String``."""
    return name.replace("/", "/msg/") if name.count("/") == 1 else name
