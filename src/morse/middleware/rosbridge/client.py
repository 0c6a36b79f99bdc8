"""One client of rosbridge, and the operations that arrive from it, also in fragments."""

from __future__ import annotations

import asyncio
import itertools
import math
from typing import TYPE_CHECKING, Any, NamedTuple

import msgspec

from morse.core.reports.quoting import nearest, short
from morse.core.status import PREEMPTED
from morse.middleware.rosbridge import rosapi
from morse.middleware.rosbridge.forms import COMPRESSIONS
from morse.middleware.web.hub import HubClient

if TYPE_CHECKING:
    from collections.abc import Iterator

    from websockets.asyncio.server import ServerConnection

    from morse.middleware.web.hub import Hub
    from morse.middleware.web.topics import WebTopic


Raw = msgspec.Raw


class Operation(msgspec.Struct):
    """An operation; fields that it does not use are ignored.

    Attributes:
        op: name of the operation.
        id: chosen by the client; responses contain it, too.
    """

    op: str
    id: str | int | None = None
    topic: str | None = None
    type: str | None = None
    msg: Raw = Raw()
    throttle_rate: float = 0.0
    queue_length: float = 0.0
    service: str | None = None
    args: Raw = Raw()
    level: str | None = None
    compression: str | None = None
    action: str | None = None
    fragment_size: float | None = None
    data: str = ""
    num: int = 0
    total: int = 0


def parse(frame: str | bytes) -> Operation:
    """Parse the operation of a message.

    Raises:
        ValueError: it is not a valid operation.
    """
    try:
        return _decoder.decode(frame)
    except (msgspec.DecodeError, RecursionError, UnicodeDecodeError) as error:
        raise ValueError(f"not an operation of rosbridge: {error}") from None


_decoder = msgspec.json.Decoder(Operation)


#: characters of all parts of a client that wait for others, parts of a message, and messages of which parts lack
MOST, _MOST_PARTS, _MOST_OPEN = 1 << 20, 1 << 14, 8
_SMALLEST = 128

_numbers = itertools.count(1)


class Parts:
    """A message in parts, each of which is made when it is sent: there may be thousands.

    Args:
        frame: the message.
        size: maximum number of characters of a part, about.
    """

    def __init__(self, frame: str, size: float) -> None:
        self._frame, self._length = frame, max(_SMALLEST, int(size))

    def __len__(self) -> int:
        return len(self._frame)

    def __iter__(self) -> Iterator[str]:
        """The parts; the message itself if it is not longer than one."""
        frame, length = self._frame, self._length
        if len(frame) <= length:
            yield frame
            return
        number, total = f"fragment:{next(_numbers)}", -(-len(frame) // length)
        for index in range(total):
            data = frame[index * length : (index + 1) * length]
            part = {"op": "fragment", "id": number, "data": data, "num": index, "total": total}
            yield msgspec.json.encode(part).decode()


class Puzzle:
    """Puts messages of a client together."""

    def __init__(self) -> None:
        #: the pieces of each message by its id, and how many it has
        self._open: dict[str | int | None, tuple[int, dict[int, str]]] = {}
        self._size = 0

    def add(self, operation: Operation) -> str | None:
        """Add a part; the message if it is complete.

        Raises:
            ValueError: the part is not valid, or all parts together are too long.
        """
        total, index = operation.total, operation.num
        if not 0 < total <= _MOST_PARTS or not 0 <= index < total:
            raise ValueError(f"'fragment' needs 'total' from 1 to {_MOST_PARTS}, and 'num' from 0 and below it")
        if operation.id not in self._open and len(self._open) >= _MOST_OPEN:
            self._close(next(iter(self._open)))
        count, pieces = self._open.setdefault(operation.id, (total, {}))
        self._size += len(operation.data) - len(pieces.get(index, ""))
        pieces[index] = operation.data
        if count != total or self._size > MOST:
            self._close(operation.id)
            raise ValueError(f"fragments of a message have one 'total'; those of all have at most {MOST} characters")
        if len(pieces) < total:
            return None
        self._close(operation.id)
        return "".join(pieces[number] for number in range(total))

    def _close(self, number: str | int | None) -> None:
        _, pieces = self._open.pop(number)
        self._size -= sum(map(len, pieces.values()))


_LEVELS = ("none", "error", "warning", "info")
#: maximum number of subscriptions to one topic, which are compared with each other
_MOST_OF_TOPIC = 1024
_LONGEST_NAME = 256
#: constants of action_msgs/GoalStatus
_SUCCEEDED, _CANCELED, _ABORTED = 4, 5, 6


class _Wish(NamedTuple):
    """The options of a subscription.

    Attributes:
        interval: minimum wall-clock time between two messages, s.
        depth: maximum number of queued messages; 0 for the queue depth of the topic.
        compression: one of `COMPRESSIONS`.
        part: maximum number of characters in a message; infinite for any. Those that are longer come in parts.
    """

    interval: float
    depth: int
    compression: str
    part: float


class _Goal(NamedTuple):
    """A goal of an action, as a call of a service: the id that the client has chosen, and the name of the action."""

    id: Any
    action: str


class RosbridgeClient(HubClient):
    """Executes the operations of a client."""

    def __init__(self, hub: Hub, connection: ServerConnection) -> None:
        super().__init__(hub, connection)
        self._level = 1
        self._puzzle = Puzzle()
        #: subscriptions of each topic, by id
        self._wishes: dict[str, dict[object, _Wish]] = {}
        self._last: dict[str, float] = {}

    # -- topics ------------------------------------------------------------------------------

    def show(self, topic: WebTopic, frame: Any) -> None:
        """See `HubClient.show`."""
        wish: _Wish = topic.readers[self]
        if wish.interval > 0.0:
            now = asyncio.get_running_loop().time()
            if now - self._last.get(topic.topic, -math.inf) < wish.interval:
                return
            self._last[topic.topic] = now
        data = frame.frame(wish.compression)
        if isinstance(data, str) and math.isfinite(wish.part):
            data = Parts(data, wish.part)
        is_queued = self.offer(topic.topic, data, wish.depth or topic.qos.depth)
        if not is_queued and topic.qos.reliable:
            self.hub.server.complain(self, f"slow {self.peer}", f"reads {topic.topic} too slowly, it misses messages")

    def topic_added(self, topic: WebTopic) -> None:
        """See `HubClient.topic_added`."""
        if topic.topic in self._wishes:
            self._attach(topic)

    def _attach(self, topic: WebTopic) -> None:
        wishes = self._wishes[topic.topic].values()
        is_new = self not in topic.readers
        topic.readers[self] = _Wish(
            min(wish.interval for wish in wishes),
            max(wish.depth for wish in wishes),
            # as rosbridge_suite: one subscription with compression compresses for all of them
            max((wish.compression for wish in wishes), key=COMPRESSIONS.index),
            min(wish.part for wish in wishes),
        )
        if is_new:
            for stamp, data in tuple(topic.kept):
                self.show(topic, self.hub.frame(topic, stamp, data))

    def _subscribe(self, operation: Operation) -> None:
        name = self._topic_of(operation)
        topic = self._offered(name)
        if topic is not None and operation.type and _of_ros_2(operation.type) != topic.type:
            raise ValueError(f"the topic {short(name)} has the type {topic.type}, not {short(operation.type)}")
        rate, depth = operation.throttle_rate, operation.queue_length
        compression = operation.compression or "none"
        if compression not in COMPRESSIONS:
            raise ValueError(f"the compression {short(compression)} is none of {', '.join(COMPRESSIONS)}")
        part = operation.fragment_size or math.inf
        wish = _Wish(max(0.0, rate) / 1000.0, int(min(max(0.0, depth), 1000.0)), compression, part)
        wishes = self._wishes.get(name, {})
        if operation.id not in wishes:
            if len(wishes) >= _MOST_OF_TOPIC:
                raise ValueError(f"more than {_MOST_OF_TOPIC} subscriptions to {short(name)}")
            self.keep(_size(name, operation.id), "a subscription")
        self._wishes.setdefault(name, wishes)[operation.id] = wish
        if topic is not None:
            self._attach(topic)

    def _unsubscribe(self, operation: Operation) -> None:
        name = self._topic_of(operation)
        wishes = self._wishes.get(name, {})
        for number in list(wishes) if operation.id is None else [operation.id]:
            if wishes.pop(number, None) is not None:
                self.release(_size(name, number))
        topic = self._offered(name)
        if wishes:
            if topic is not None:
                self._attach(topic)
            return
        self._wishes.pop(name, None)
        self._last.pop(name, None)
        if topic is not None:
            topic.readers.pop(self, None)

    def _offered(self, name: str) -> WebTopic | None:
        return self.hub.topics.offered.get(name) if self.hub.topics is not None else None

    def _topic_of(self, operation: Operation) -> str:
        if not operation.topic or len(operation.topic) > _LONGEST_NAME:
            raise ValueError(f"'{operation.op}' needs 'topic', the name of a topic")
        # rosbridge also accepts names without the leading slash
        return operation.topic if operation.topic.startswith("/") else "/" + operation.topic

    def _advertise(self, operation: Operation) -> None:
        name = self._topic_of(operation)
        subscription = self.hub.topics.heard.get(name) if self.hub.topics is not None else None
        if subscription is not None and operation.type and _of_ros_2(operation.type) != subscription.type:
            raise ValueError(f"the topic {short(name)} has the type {subscription.type}, not {short(operation.type)}")

    def _unadvertise(self, operation: Operation) -> None:
        self._topic_of(operation)

    def _publish(self, operation: Operation) -> None:
        name = self._topic_of(operation)
        subscriptions = self.hub.topics.heard if self.hub.topics is not None else {}
        data = bytes(operation.msg)
        if not data:
            raise ValueError("'publish' needs 'msg', the message")
        if name not in subscriptions:
            text = f"no component subscribes to {short(name)}{nearest(name, subscriptions)}"
            self.hub.server.complain(self, "nobody", text)
            self._status("warning", text, operation.id)
            return
        for inlet in subscriptions[name].inlets:
            inlet.put(data)

    # -- services ----------------------------------------------------------------------------

    def _call_service(self, operation: Operation) -> None:
        service = operation.service
        if not service:
            raise ValueError("'call_service' needs 'service', the name of a service")
        service = service if service.startswith("/") else "/" + service
        call = (operation.id, service)
        if service.startswith("/rosapi/"):
            values = rosapi.answer(self.hub, service, msgspec.json.decode(operation.args or b"null"))
            if values is None:
                self.answer(call, f"there is no service {short(service)}{nearest(service, rosapi.SERVICES)}", b"")
            else:
                self.answer(call, None, msgspec.json.encode(values))
        elif self.hub.requests is None:
            self.answer(call, f"there is no service {short(service)}: the scene offers none on rosbridge", b"")
        else:
            self.hub.requests.call(self, call, service, bytes(operation.args))

    def _send_goal(self, operation: Operation) -> None:
        name = self._action_of(operation)
        call = _Goal(operation.id, name)
        if self.hub.requests is None:
            self.answer(call, f"there is no action {short(name)}: the scene offers none on rosbridge", b"")
        else:
            self.hub.requests.call(self, call, name, bytes(operation.args))

    def _cancel_goal(self, operation: Operation) -> None:
        if self.hub.requests is not None:
            self.hub.requests.cancel(self, _Goal(operation.id, self._action_of(operation)))

    def _action_of(self, operation: Operation) -> str:
        name = operation.action
        if not name:
            raise ValueError(f"'{operation.op}' needs 'action', the name of a service that takes time")
        return name if name.startswith("/") else "/" + name

    def _answer_goal(self, goal: _Goal, error: str | None, value: bytes) -> None:
        status = _SUCCEEDED if error is None else _CANCELED if error.startswith(PREEMPTED) else _ABORTED
        if error is not None:
            values = msgspec.json.encode({"error": error})
        else:
            values = value if value.startswith(b"{") else b'{"result":' + value + b"}"
        # clients expect a result that was cancelled as one that has failed
        head = {"op": "action_result", "action": goal.action, "status": status, "result": error is None}
        if goal.id is not None:
            head["id"] = goal.id
        self.tell((msgspec.json.encode(head)[:-1] + b',"values":' + values + b"}").decode())

    def answer(self, call: Any, error: str | None, value: bytes) -> None:
        """See `HubClient.answer`."""
        if isinstance(call, _Goal):
            self._answer_goal(call, error, value)
            return
        number, service = call
        if error is not None:
            values = msgspec.json.encode(error)
        else:
            # 'values' is an object: the fields of the response of a ROS service
            values = value if value.startswith(b"{") else b'{"result":' + value + b"}"
        head = {"op": "service_response", "service": service, "result": error is None}
        if number is not None:
            head["id"] = number
        self.tell((msgspec.json.encode(head)[:-1] + b',"values":' + values + b"}").decode())

    # -- other operations --------------------------------------------------------------------

    def _set_level(self, operation: Operation) -> None:
        if operation.level not in _LEVELS:
            raise ValueError(f"'level' is one of {', '.join(_LEVELS)}")
        self._level = _LEVELS.index(operation.level)

    def _fragment(self, operation: Operation) -> None:
        frame = self._puzzle.add(operation)
        if frame is not None:
            inner = parse(frame)
            if inner.op == "fragment":
                raise ValueError("a message in fragments contains a fragment")
            self._execute(inner)

    def _nothing(self, operation: Operation) -> None:
        """All connected clients have all permissions."""

    _operations = {  # noqa: RUF012 - never changed
        "subscribe": _subscribe,
        "unsubscribe": _unsubscribe,
        "advertise": _advertise,
        "unadvertise": _unadvertise,
        "publish": _publish,
        "call_service": _call_service,
        "send_action_goal": _send_goal,
        "cancel_action_goal": _cancel_goal,
        "set_level": _set_level,
        "auth": _nothing,
        "fragment": _fragment,
    }

    def received(self, frame: str | bytes) -> None:
        """See `WebClient.received`."""
        number = None
        try:
            operation = parse(frame)
            number = operation.id
            self._execute(operation)
        except ValueError as error:
            self.hub.server.complain(self, "refused", str(error))
            self._status("error", str(error), number)

    def _execute(self, operation: Operation) -> None:
        method = self._operations.get(operation.op)
        if method is None:
            raise ValueError(
                f"the operation {short(operation.op)} is not supported{nearest(operation.op, self._operations)}"
            )
        method(self, operation)

    def _status(self, level: str, text: str, number: Any) -> None:
        if _LEVELS.index(level) <= self._level:
            message = {"op": "status", "level": level, "msg": text}
            if number is not None:
                message["id"] = number
            self.tell(msgspec.json.encode(message).decode())


def _size(name: str, number: object) -> int:
    """The size of a subscription to a topic."""
    return len(name) + len(str(number))


def _of_ros_2(name: str) -> str:
    """Convert ``std_msgs/String`` of ROS 1 to ``std_msgs/msg/String``."""
    return name.replace("/", "/msg/") if name.count("/") == 1 else name
