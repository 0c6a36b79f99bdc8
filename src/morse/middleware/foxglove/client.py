"""One client of Foxglove."""

from __future__ import annotations

import uuid
from typing import TYPE_CHECKING, Any

import msgspec

from morse.core.reports.hints import nearest
from morse.core.reports.quoting import short, shown
from morse.middleware.foxglove import frames
from morse.middleware.web.hub import HubClient
from morse.rosmsgs.definitions import definition

if TYPE_CHECKING:
    from collections.abc import Callable

    from websockets.asyncio.server import ServerConnection

    from morse.middleware.web.topics import WebTopic

_ENCODINGS = ("cdr", "json")
_ERROR = 2
_LARGEST = 2**32 - 1
#: bytes that are counted for the name of a topic
_LONGEST_TOPIC = 256


class FoxgloveClient(HubClient):
    """Implements ``foxglove.websocket.v1`` and ``foxglove.sdk.v1``, which are identical in the parts used here."""

    def __init__(self, hub: Any, connection: ServerConnection) -> None:
        super().__init__(hub, connection)
        #: id of a subscription to its topic
        self._subscriptions: dict[int, WebTopic] = {}
        #: id of a channel of the client to its topic
        self._channels: dict[int, str] = {}
        self._services: frozenset[int] = frozenset()

    def begin(self) -> None:
        """See `WebClient.begin`."""
        self._say(
            op="serverInfo",
            name="MORSE",
            capabilities=["clientPublish", "services", "time"],
            supportedEncodings=list(_ENCODINGS),
            metadata={},
            sessionId=str(uuid.uuid4()),
        )
        if self.hub.topics is not None and self.hub.topics.offered:
            self._advertise_topics(list(self.hub.topics.offered.values()))
        self.services_changed()

    def _say(self, **message: Any) -> None:
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

    def topic_removed(self, topic: WebTopic) -> None:
        """See `HubClient.topic_removed`."""
        for number in [number for number, one in self._subscriptions.items() if one is topic]:
            del self._subscriptions[number]
            self.release(0)
        self._say(op="unadvertise", channelIds=[topic.number])

    def show(self, topic: WebTopic, frame: Any) -> None:
        """See `HubClient.show`."""
        taken = self.offer(topic.number, frames.message(topic.readers[self], frame), topic.qos.depth)
        if not taken and topic.qos.reliable:
            self.hub.server.complain(self, f"slow {self.peer}", f"reads {topic.topic} too slowly, it misses messages")

    def tick(self, stamp: int) -> None:
        """See `HubClient.tick`."""
        self.offer("time", frames.time(stamp), 1)

    def _subscribe(self, message: dict[str, Any]) -> None:
        offered = self.hub.topics.offered.values() if self.hub.topics is not None else ()
        by_number = {topic.number: topic for topic in offered}
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

    def _unsubscribe(self, message: dict[str, Any]) -> None:
        for number in _numbers(message, "subscriptionIds"):
            topic = self._subscriptions.pop(number, None)
            if topic is None:
                raise ValueError(f"there is no subscription {number}")
            self.release(0)
            topic.readers.pop(self, None)

    # -- messages of the client --------------------------------------------------------------

    def _advertise(self, message: dict[str, Any]) -> None:
        heard = self.hub.topics.heard if self.hub.topics is not None else {}
        for one in _records(message, "channels"):
            number, topic, kind = _number(one, "id"), one.get("topic"), one.get("schemaName")
            if not isinstance(topic, str) or topic not in heard:
                raise ValueError(f"no component subscribes to {short(topic)}{nearest(str(topic)[:256], heard)}")
            if one.get("encoding") not in _ENCODINGS:
                raise ValueError(f"the encoding {shown(one.get('encoding'))} is none of {', '.join(_ENCODINGS)}")
            if isinstance(kind, str) and kind and _of_ros_2(kind) != heard[topic].type:
                raise ValueError(f"the topic {topic} has the type {heard[topic].type}, not {short(kind)}")
            if number not in self._channels:
                self.keep(_LONGEST_TOPIC, "a channel")
            self._channels[number] = topic

    def _unadvertise(self, message: dict[str, Any]) -> None:
        for number in _numbers(message, "channelIds"):
            if self._channels.pop(number, None) is not None:
                self.release(_LONGEST_TOPIC)

    def _publish(self, published: frames.Published) -> None:
        topic = self._channels.get(published.channel)
        if topic is None:
            raise ValueError(f"the channel {published.channel} was not advertised")
        heard = self.hub.topics.heard.get(topic) if self.hub.topics is not None else None
        for inlet in heard.inlets if heard is not None else ():
            inlet.put(published.data)

    # -- services ----------------------------------------------------------------------------

    def services_changed(self) -> None:
        """See `HubClient.services_changed`."""
        known = self.hub.services()  # type: ignore[attr-defined] # it is a FoxgloveHub
        gone = sorted(self._services - known.keys())
        new = sorted(known.keys() - self._services)
        self._services = frozenset(known)
        if gone:
            self._say(op="unadvertiseServices", serviceIds=gone)
        if new:
            self._say(op="advertiseServices", services=[self._service(number, known[number]) for number in new])

    def _service(self, number: int, path: str) -> dict[str, Any]:
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
        service, number = call
        if error is not None:
            self._say(op="serviceCallFailure", serviceId=service, callId=number, message=error)
        else:
            data = value if value.startswith(b"{") else b'{"result":' + value + b"}"
            self.tell(frames.answer(service, number, "json", data))

    # -- received messages -------------------------------------------------------------------

    def received(self, frame: str | bytes) -> None:
        """See `WebClient.received`."""
        try:
            if isinstance(frame, str):
                self._operate(frame)
            else:
                parsed = frames.parse(frame)
                if isinstance(parsed, frames.Call):
                    self._call(parsed)
                else:
                    self._publish(parsed)
        except ValueError as error:
            self.hub.server.complain(self, "refused", str(error))
            self._status(_ERROR, str(error))

    def _operate(self, frame: str) -> None:
        try:
            message = msgspec.json.decode(frame)
        except (msgspec.DecodeError, RecursionError, UnicodeDecodeError, UnicodeEncodeError) as error:
            raise ValueError(f"not JSON: {error}") from None
        operations: dict[str, Callable[[dict[str, Any]], None]] = {
            "subscribe": self._subscribe,
            "unsubscribe": self._unsubscribe,
            "advertise": self._advertise,
            "unadvertise": self._unadvertise,
        }
        name = message.get("op") if isinstance(message, dict) else None
        if not isinstance(name, str) or name not in operations:
            raise ValueError(f"the operation {shown(name)} is not supported{nearest(str(name)[:64], operations)}")
        operations[name](message)


def _schema(name: str, schema: dict[str, Any]) -> dict[str, str]:
    text = msgspec.json.encode(schema).decode()
    return {"encoding": "json", "schemaName": name, "schemaEncoding": "jsonschema", "schema": text}


def _records(message: dict[str, Any], name: str) -> list[dict[str, Any]]:
    given = message.get(name)
    if not isinstance(given, list) or not all(isinstance(one, dict) for one in given):
        raise ValueError(f"'{name}' is {shown(given)}, expected a list of objects")
    return given


def _numbers(message: dict[str, Any], name: str) -> list[int]:
    given = message.get(name)
    if not isinstance(given, list):
        raise ValueError(f"'{name}' is {shown(given)}, expected a list of numbers")
    return [_number({"item": one}, "item") for one in given]


def _number(record: dict[str, Any], name: str) -> int:
    given = record.get(name)
    if isinstance(given, bool) or not isinstance(given, int) or not 0 <= given <= _LARGEST:
        raise ValueError(f"'{name}' is {shown(given)}, expected a number from 0 to {_LARGEST}")
    return given


def _of_ros_2(name: str) -> str:
    """Convert ``std_msgs/String`` of ROS 1 to ``std_msgs/msg/String``."""
    return name.replace("/", "/msg/") if name.count("/") == 1 else name
