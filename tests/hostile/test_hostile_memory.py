"""What one client leaves behind has one budget, in bytes, which is free again when it has gone."""

import json
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import pytest

from morse.core.clients.budgets import CLIENT_BYTES, ENTRY, PARSED, Budget, OverBudget, TimeShares
from morse.middleware.foxglove.client import FoxgloveClient
from morse.middleware.rosbridge.client import RosbridgeClient
from morse.middleware.web.client import WebClient
from morse.middleware.web.requests import WebRequestManager
from morse.plugins.yarp.ports import WaitingBottles
from morse.viewer import page_messages as pm
from morse.viewer.hub import Hub
from morse.viewer.page import Page
from tests.kit.waiting import run_apart

LARGEST_MESSAGE = 1 << 20
MOST = 20 << 20
"""What one client may add to the memory of the simulation, bytes."""


def size_of(value: Any, seen: set[int] | None = None) -> int:
    """The bytes of a table and of everything in it."""
    import sys

    seen = set() if seen is None else seen
    if id(value) in seen:
        return 0
    seen.add(id(value))
    inner = [*value.keys(), *value.values()] if isinstance(value, dict) else value
    parts = inner if isinstance(inner, (list, tuple, set, frozenset)) else ()
    return sys.getsizeof(value) + sum(size_of(part, seen) for part in parts)


class Connection:
    """The connection of a WebSocket whose client reads nothing."""

    remote_address = ("127.0.0.1", 5)

    def __init__(self) -> None:
        self.is_open = True
        self.transport = SimpleNamespace(abort=self._abort, get_write_buffer_size=lambda: 0)

    def _abort(self) -> None:
        self.is_open = False


class Topic(SimpleNamespace):
    """A topic of the simulation."""


def hub(**parts: Any) -> Any:
    told: list[str] = []
    server = SimpleNamespace(complain=lambda client, kind, text: told.append(text), clients=set())
    topics = SimpleNamespace(offered={}, heard={})
    return SimpleNamespace(server=server, topics=topics, requests=None, told=told, graph_changed=lambda: None, **parts)


# the budget -----------------------------------------------------------------------------------


def test_a_budget_is_never_exceeded_by_what_asks_first() -> None:
    budget = Budget(1000)
    budget.charge(600, "a call")
    with pytest.raises(OverBudget, match="a call is refused: it takes 500 bytes, and 400 of 1000"):
        budget.charge(500, "a call")
    budget.give(600)
    assert budget.left == 1000


@pytest.mark.parametrize("text", ["[" + "[]," * 9999 + "[]]", "[" + "{}," * 9999 + "{}]", '["' + 'a","' * 9999 + '"]'])
def test_parsed_messages_are_not_larger_than_they_are_counted(text: str) -> None:
    assert size_of(json.loads(text)) <= PARSED * len(text)


# rosbridge ------------------------------------------------------------------------------------


def operation(**fields: Any) -> str:
    return json.dumps(fields)


NAMES: dict[str, Callable[[int], dict[str, Any]]] = {
    "ids of one topic": lambda n: {"op": "subscribe", "topic": "/one", "id": f"{n}" + "x" * 100_000},
    "ids of many topics": lambda n: {"op": "subscribe", "topic": f"/t{n}", "id": "x" * 2000},
    "short topics": lambda n: {"op": "subscribe", "topic": f"/{n}"},
    "advertised": lambda n: {"op": "advertise", "topic": f"/t{n}" + "x" * 200, "type": "std_msgs/String"},
    "throttled": lambda n: {"op": "subscribe", "topic": f"/t{n}", "throttle_rate": n},
}


@pytest.mark.parametrize("flood", NAMES)
def test_what_a_client_of_rosbridge_asks_for_has_one_budget(flood: str) -> None:
    middle = hub()
    client = RosbridgeClient(middle, Connection())  # type: ignore[arg-type] # stand-ins
    asked, before = 0, len(middle.told)
    while asked < 4 * MOST and len(middle.told) == before:
        text = operation(**NAMES[flood](asked))
        client.received(text)
        asked += len(text)
    assert size_of(client._wishes) < MOST
    assert flood == "advertised" or middle.told, "it is told"


def test_unsubscribing_frees_the_memory() -> None:
    client = RosbridgeClient(hub(), Connection())  # type: ignore[arg-type] # stand-ins
    for _ in range(3):
        for number in range(100):
            client.received(operation(op="subscribe", topic=f"/t{number % 10}", id=f"{number}"))
            client.received(operation(op="subscribe", topic=f"/t{number % 10}", id=f"{number}"))
        assert client.memory.left < CLIENT_BYTES - 100 * ENTRY
        client.received(operation(op="unsubscribe", topic="/t0", id="0"))
        client.received(operation(op="unsubscribe", topic="/t0", id="0"))
        for number in range(10):
            client.received(operation(op="unsubscribe", topic=f"/t{number}"))
        while client._waiting:  # status messages
            client._drop(next(iter(client._waiting)))
        assert client.memory.left == CLIENT_BYTES


# services of WebSockets -----------------------------------------------------------------------


@pytest.fixture
def manager(monkeypatch: pytest.MonkeyPatch) -> Any:
    monkeypatch.setattr("morse.middleware.web.requests.hub_of", lambda *_: SimpleNamespace(name="web"))
    manager_class = type("Manager", (WebRequestManager,), {"hub_class": None, "classpath": "x"})
    scene = SimpleNamespace(settings=SimpleNamespace(node_name="morse"), manager_options={})
    context: Any = SimpleNamespace(scene=scene, journal=SimpleNamespace(note=lambda *_: None), wake=lambda: None)
    context.time_shares = TimeShares()
    context.network = SimpleNamespace(post=lambda function, *args: function(*args))
    return manager_class(context)


def test_calls_that_wait_have_the_budget_of_their_client(manager: Any) -> None:
    middle = hub()
    middle.requests = manager
    client = RosbridgeClient(middle, Connection())  # type: ignore[arg-type] # stand-ins
    arguments = [[]] * 200_000
    text = operation(op="call_service", service="/x/y", id="1", args=arguments)
    for _ in range(60):
        client.received(text)
    waiting = [request for queue in manager._inbox._waiting.values() for _, request in queue]
    assert 1 < len(waiting) <= CLIENT_BYTES // len(text) + 1
    assert size_of(waiting) < MOST
    assert manager._outbox == []
    manager._share.is_used = lambda: False
    manager.main()
    manager._hand_over()
    assert client.calls == 0
    while client._waiting:
        client._drop(next(iter(client._waiting)))
    assert client.memory.left == CLIENT_BYTES


def test_wrong_json_of_a_call_is_answered(manager: Any) -> None:
    class Listener(WebClient):
        calls = 0

        def answer(self, call: Any, error: str | None, value: bytes) -> None:
            answers.append((call, error))

    answers: list[Any] = []
    manager.paths = {"/a/b": ("a", "b")}
    client = Listener(Connection())  # type: ignore[arg-type] # a stand-in
    manager.call(client, (1, 2), "/a/b", b"[1,")
    manager.main()
    manager._hand_over()
    ((call, error),) = answers
    assert call == (1, 2)
    assert "not JSON" in error


# sending --------------------------------------------------------------------------------------


def test_data_give_way_to_requests_and_answers_do_not() -> None:
    client = WebClient(Connection())  # type: ignore[arg-type] # a stand-in
    for number in range(64):
        client.offer(number, b"x" * LARGEST_MESSAGE, 1)
    assert CLIENT_BYTES - client.memory.left <= CLIENT_BYTES
    client.keep(8 << 20, "a call")
    client.tell(b"x" * LARGEST_MESSAGE)
    assert client.memory.left >= 0
    assert any(key is None for key, _ in client._waiting.values())
    for _ in range(16):
        client.tell(b"x" * LARGEST_MESSAGE)
    assert not client.connection.is_open  # type: ignore[attr-defined] # a stand-in


def test_one_frame_that_is_larger_than_the_budget_is_sent() -> None:
    client = WebClient(Connection())  # type: ignore[arg-type] # a stand-in
    assert client.offer("cloud", bytes(2 * CLIENT_BYTES), 1)
    client.offer("cloud", bytes(2 * CLIENT_BYTES), 1)
    assert len(client._waiting) == 1


# Foxglove -------------------------------------------------------------------------------------


def test_channels_of_foxglove_have_the_budget() -> None:
    middle = hub()
    middle.topics.heard["/motion"] = SimpleNamespace(type="geometry_msgs/msg/Twist", inlets=())
    client = FoxgloveClient(middle, Connection())  # type: ignore[arg-type] # stand-ins
    channel = {"topic": "/motion", "encoding": "json", "schemaName": "geometry_msgs/msg/Twist"}
    for first in range(0, 100_000, 1000):
        ids = range(first, first + 1000)
        client.received(json.dumps({"op": "advertise", "channels": [{**channel, "id": number} for number in ids]}))
    assert middle.told
    assert size_of(client._channels) < MOST
    numbers = list(client._channels)
    for first in range(0, len(numbers), 1000):
        client.received(json.dumps({"op": "unadvertise", "channelIds": numbers[first : first + 1000]}))
    while client._waiting:
        client._drop(next(iter(client._waiting)))
    assert client.memory.left == CLIENT_BYTES


# pages ----------------------------------------------------------------------------------------


def test_requests_of_a_page_have_its_budget(caplog: pytest.LogCaptureFixture) -> None:
    from morse.core.clients.budgets import Arrivals
    from morse.core.clients.web_access import Access
    from morse.viewer.view_messages import Answer

    async def make() -> Page:
        return Page(1, Connection())  # type: ignore[arg-type] # a stand-in

    hub = Hub(Access("127.0.0.1", None), "title", Arrivals())
    page = run_apart(make())
    hub._pages[1] = page
    hub.control_lock.enter(1)
    size = 256 << 10
    for number in range(1, 101):
        hub._receive(page, pm.CallService(number, "c", "s", [[]] * (size // 3)), size)
    assert len(hub.events) * PARSED * size < MOST
    assert caplog.text.count("a request is refused") == 1
    for event in list(hub.events):
        hub.answer(Answer(event.request, ok=True))  # type: ignore[attr-defined] # a call
    for _ in range(200):
        hub._receive(page, pm.CallService(1000, "c", "s", []), 100)
        hub.answer(Answer(hub.events[-1].request, ok=True))  # type: ignore[attr-defined] # a call
    assert not page.hopeless
    sent = sum(len(frame) for frame in page._waiting.values())
    assert page.memory.left == CLIENT_BYTES - sent


def test_a_page_that_reads_no_answers_is_disconnected() -> None:
    async def make() -> Page:
        return Page(1, Connection())  # type: ignore[arg-type] # a stand-in

    page = run_apart(make())
    count = 0
    while not page.hopeless:
        page.tell(None, "x" * LARGEST_MESSAGE)
        count += 1
    assert count * LARGEST_MESSAGE <= MOST


# YARP -----------------------------------------------------------------------------------------


@pytest.mark.parametrize(("count", "most"), [(1 << 17, 64), (100, 64), (1 << 17, 1024)])
def test_bottles_that_wait_have_a_budget_and_the_newest_stay(count: int, most: int) -> None:
    queue: WaitingBottles[int] = WaitingBottles(most)
    for number in range(3000):
        queue.append(number, count)
    assert len(queue) <= most
    assert (len(queue) - 1) * PARSED * count < CLIENT_BYTES
    values = [queue.popleft() for _ in range(len(queue))]
    assert values == list(range(3000 - len(values), 3000))
    assert queue._memory.left == CLIENT_BYTES
    with pytest.raises(IndexError):
        queue.popleft()


# actions --------------------------------------------------------------------------------------


def test_finished_goals_of_ros_1_are_forgotten_also_while_no_time_passes() -> None:
    from morse.plugins.ros.actions import _ACTIVE, _SUCCEEDED, ActionServer

    server: Any = ActionServer.__new__(ActionServer)
    server._now, server._stamp = 1.0, 10**9
    server._status = SimpleNamespace(publish=lambda _: None)
    goals = [SimpleNamespace(id=number, status=_SUCCEEDED, text="", ended_at=1.0) for number in range(5000)]
    goals.append(SimpleNamespace(id=5000, status=_ACTIVE, text="", ended_at=float("inf")))
    server._goals = goals
    with pytest.MonkeyPatch.context() as patch:
        made = SimpleNamespace(status_list=[])
        patch.setattr(
            "morse.plugins.ros.actions.message", lambda name, _: made if "Array" in name else SimpleNamespace()
        )
        patch.setattr("morse.plugins.ros.actions.time", lambda _: None)
        server._tell()
    assert len(made.status_list) <= 100
    assert made.status_list[-1].goal_id == 5000
    assert len(server._goals) <= 100
