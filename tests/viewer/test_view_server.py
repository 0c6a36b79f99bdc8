"""The server between a simulation and its pages."""

import contextlib
import json
import math
import socket
import time
from types import SimpleNamespace

import numpy as np
import pytest
from view_pages import Client, DeadPage, fetch, port_of
from view_worlds import box, mesh_node
from websockets.exceptions import ConnectionClosed

from morse.core.clients.network import Network
from morse.scene import Scene
from morse.viewer.page import DEAD_MAN
from morse.viewer.page_messages import CallService, Drag, DragEnd, Pause, SetSpeed, Step
from morse.viewer.protocol import MAX_MESSAGE, VERSION, Close
from morse.viewer.server import ViewServer
from morse.viewer.snapshot import MovingNode, Snapshot
from morse.viewer.view_messages import Answer, Appearance, Listening, Log, Rays, Values
from tests.kit.waiting import wait_until


def one_box() -> tuple[Scene, list[MovingNode]]:
    node = mesh_node("box", box("box"))
    return Scene("s", roots=[node]), [MovingNode(node)]


def snapshot(tick: int, status: str = "running") -> Snapshot:
    poses = np.array([[tick, 0, 0, 1, 0, 0, 0]], dtype=np.float32)
    return Snapshot(tick, tick / 60, 1, poses, status, 1.0, 0.97)  # type: ignore[arg-type]


@pytest.fixture
def patient(monkeypatch: pytest.MonkeyPatch) -> None:
    """Keys stay held although these pages send no heartbeat: on a busy machine, the test may look late."""
    monkeypatch.setattr("morse.viewer.page.DEAD_MAN", 1e9)


def closing(client: Client) -> tuple[int, str]:
    try:
        while True:
            client.receive()
    except ConnectionClosed as closed:
        return (closed.rcvd.code, closed.rcvd.reason) if closed.rcvd else (0, "")


# connecting ----------------------------------------------------------------------------------------------


def test_a_port_in_use_gives_way_to_the_next_free_one_and_that_is_said(network, caplog) -> None:
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = taken.getsockname()[1]
        server = ViewServer(network, port=port)
        url = server.start()
        assert url.startswith("http://127.0.0.1:")
        assert not url.endswith(f":{port}/")
        assert f"port {port} is in use: the live view is served on port {port_of(url)}" in caplog.text
        assert fetch(url)[0] == 200
        server.stop()


def test_an_address_that_cannot_be_bound_says_what_to_do(network) -> None:
    with pytest.raises(OSError, match="--view none"):
        ViewServer(network, host="192.0.2.1", port=0, token="t").start()


def test_watched_only_while_a_page_is_there(served) -> None:
    server, url = served
    assert not server.watched
    with Client(url) as page:
        assert page.expect("welcome")["version"] == VERSION
        assert server.watched
    wait_until(lambda: not server.watched)


def test_a_world_counts_as_drawn_when_a_page_has_said_so(served) -> None:
    server, url = served
    with Client(url) as page:
        page.expect("welcome")
        assert not server.drawn
        page.send("shown")
        wait_until(lambda: server.drawn)
    wait_until(lambda: not server.drawn)


@pytest.mark.parametrize(
    ("frame", "code", "reason"),
    [
        (json.dumps({"type": "hello", "version": VERSION + 1}), Close.OTHER_VERSION, "reload the page"),
        (
            json.dumps({"type": "hello", "version": 0}),
            Close.OTHER_VERSION,
            f"version 0 of the protocol, the simulator {VERSION}",
        ),
        ("garbage", Close.NOT_UNDERSTOOD, "Not understood"),
        ('{"type": "pause"}', Close.NOT_UNDERSTOOD, "must be hello"),
        ('{"type": "' + "ü" * 200 + '"}', Close.NOT_UNDERSTOOD, "Not understood"),
        (b"\x01\x02", Close.NOT_UNDERSTOOD, "binary"),
    ],
)
def test_a_bad_beginning_is_told_why_it_ends(served, frame, code, reason) -> None:
    server, url = served
    with Client(url, hello=False) as page:
        page.socket.send(frame)
        got, why = closing(page)
    assert got == code
    assert reason in why
    assert not server.watched


@pytest.mark.parametrize(
    "frame", ["{}", "[1]", '{"type": "keys", "held": 3}', '{"type": "hello", "version": 1}', b"\x00" * 10]
)
def test_garbage_later_on_closes_that_page_alone(served, frame) -> None:
    server, url = served
    with Client(url) as good, Client(url) as bad:
        good.expect("seat", pages=2)
        bad.socket.send(frame)
        assert closing(bad)[0] == Close.NOT_UNDERSTOOD
        good.expect("seat", pages=1)
        assert server.watched


def test_an_endless_message_closes_the_page(served) -> None:
    _, url = served
    with Client(url) as page:
        page.socket.send("x" * (MAX_MESSAGE + 1))
        assert closing(page)[0] == 1009


def test_bytes_that_are_no_http_do_no_harm(served) -> None:
    server, url = served
    for garbage in (
        b"\x00\xff" * 50 + b"\r\n\r\n",
        b"GET\r\n\r\n",
        b"POST / HTTP/1.1\r\nHost: localhost\r\n\r\n",
        b"GET / HTTP/1.1\r\n" + b"a: b\r\n" * 500,
    ):
        with socket.create_connection(("127.0.0.1", port_of(url))) as stranger:
            stranger.settimeout(60)
            with contextlib.suppress(OSError):  # closed before all of it was sent
                stranger.sendall(garbage)
                stranger.shutdown(socket.SHUT_WR)
                while stranger.recv(4096):
                    pass
    with Client(url) as page:
        page.expect("welcome")
        assert server.watched


def test_the_end_is_told(network) -> None:
    server = ViewServer(network, port=0)
    with Client(server.start()) as page:
        page.expect("welcome")
        server.stop()
        assert closing(page) == (1001, "The simulation has ended")


def test_stopping_does_not_wait_for_a_page_that_is_dead() -> None:
    network = Network()
    server = ViewServer(network, port=0)
    url = server.start()
    with DeadPage(url), socket.create_connection(("127.0.0.1", port_of(url))):
        wait_until(lambda: server.watched)
        began = time.monotonic()
        server.stop()
        network.stop()
        assert time.monotonic() - began < 30.0


# data for pages ------------------------------------------------------------------------------------------


def test_poses_reach_the_page(served) -> None:
    server, url = served
    server.set_scene(*one_box())
    with Client(url) as page:
        page.expect("world", revision=1)
        server.publish(snapshot(5))
        wait_until(lambda: (page.receive(), page.poses)[1])
        kind, revision, count, running, tick, simulated, speed, factor, poses = page.poses[0]
    assert (kind, revision, count, running, tick, simulated) == (1, 1, 1, 1, 5.0, 5 / 60)
    assert (speed, factor) == (1.0, pytest.approx(0.97))
    assert np.frombuffer(poses, "<f4").tolist() == [5, 0, 0, 1, 0, 0, 0]


def test_poses_never_come_before_the_world_they_belong_to(served) -> None:
    server, url = served
    with Client(url) as page:
        page.expect("seat")
        for _ in range(50):
            server.set_scene(*one_box())
            server.publish(snapshot(5, "paused"))
        known = 0
        while known < 50 or not page.poses:
            page.receive()
            known = max([known, *(m["revision"] for m in page.messages if m["type"] == "world")])
            assert all(revision <= known for _, revision, *_ in page.poses)


def test_a_snapshot_of_another_layout_is_refused(served) -> None:
    server, _ = served
    server.set_scene(*one_box())
    with pytest.raises(ValueError, match="0 poses, the scene 1 moving"):
        server.publish(Snapshot(1, 0.0, 1, np.zeros((0, 7), np.float32)))


def test_a_page_that_comes_late_is_told_what_lasts(served) -> None:
    server, url = served
    server.set_scene(*one_box())
    server.send(Appearance("box", visible=False))
    server.send(Appearance("box", visible=True, color=(1, 0, 0, 1)))
    server.send(Listening(["robot"], "robot"))
    server.send(Log("info", "said while nobody listened"))
    server.send(Answer(1, ok=True))
    server.set_scene(*one_box())
    with Client(url) as page:
        page.expect("seat")
        server.send(Log("info", "the last one", place=1))
        messages = [page.expect("log", text="the last one")]
    with Client(url) as page:
        while not any(m["type"] == "seat" for m in page.messages):
            page.receive()
        messages = page.messages
    kinds = [m["type"] for m in messages]
    assert kinds[0] == "welcome"
    assert kinds.count("appearance") == 1
    assert kinds.count("world") == 1
    assert "answer" not in kinds
    assert kinds.count("log") == 2
    assert next(m for m in messages if m["type"] == "appearance")["color"] == [1, 0, 0, 1]
    assert next(m for m in messages if m["type"] == "world")["revision"] == 2


def test_a_slow_page_sees_less_not_later_and_the_tick_does_not_wait(served) -> None:
    server, url = served
    server.set_scene(*one_box())
    with Client(url) as slow, Client(url) as quick:
        slow.expect("seat", pages=2)  # from here on it never confirms frames
        quick.expect("seat", pages=2)
        for tick in range(1, 101):
            server.send(Values("robot.pose", tick / 60, {"x": tick}))
            server.publish(snapshot(tick, "paused"))
            wait_until(lambda: (quick.receive(), quick.poses and quick.poses[-1][4] == tick)[1])  # noqa: B023
            quick.send("taken", count=len(quick.poses))
        assert len(quick.poses) == 100
        server.send(Log("info", "end"))
        slow.expect("log", text="end")
        assert len(slow.poses) <= 15
        slow.send("taken", count=len(slow.poses))
        wait_until(lambda: (slow.receive(), slow.poses[-1][4] == 100)[1])
        assert len(slow.poses) <= 16


def test_a_page_that_takes_nothing_at_all_is_given_up(served) -> None:
    server, url = served
    with DeadPage(url), Client(url) as good:
        good.expect("seat", pages=2)
        for i in range(20_000):
            server.send(Log("info", "x" * 2000, place=i))
            good.receive()
            if good.messages.pop()["type"] == "seat":
                break
        else:
            raise AssertionError("the dead page is still there")


def test_snapshots_faster_than_any_screen_are_left_out(served, monkeypatch) -> None:
    server, url = served
    server.set_scene(*one_box())
    clock = SimpleNamespace(now=time.monotonic())
    monkeypatch.setattr("morse.viewer.server.time", SimpleNamespace(monotonic=lambda: clock.now))
    with Client(url) as page:
        page.expect("world")
        for tick in range(1, 2001):  # a second
            clock.now += 1 / 2000
            page.send("taken", count=len(page.poses))
            shown = server._last_shown
            server.publish(snapshot(tick))
            if server._last_shown != shown:
                wait_until(lambda: (page.receive(), page.poses and page.poses[-1][4] == tick)[1])  # noqa: B023
        assert 118 <= len(page.poses) <= 126


def test_publish_is_cheap(served) -> None:
    server, url = served
    nodes = [mesh_node(f"n{i}", box("b")) for i in range(500)]
    server.set_scene(Scene("s", roots=nodes), [MovingNode(node) for node in nodes])
    poses = np.zeros((500, 7), np.float32)
    with Client(url) as page:
        page.expect("world")
        costs = []
        for tick in range(200):
            began = time.thread_time()
            server.publish(Snapshot(tick, 0.0, 1, poses, "paused"))
            costs.append(time.thread_time() - began)
            time.sleep(0.001)
            page.receive()
            page.send("taken", count=len(page.poses))
    assert sorted(costs)[len(costs) // 2] < 0.002  # a tick lasts 17 ms


def test_payloads_and_wishes(served) -> None:
    server, url = served
    with Client(url) as one, Client(url) as two:
        one.send("watch", values=["a"], overlays=["lidar"])
        two.send("watch", values=["b"], images=["camera"])
        wait_until(lambda: server.wishes.values == {"a", "b"} and server.wishes.images == {"camera"})
        assert server.wishes.overlays == {"lidar"}
        rays = np.arange(14, dtype="<f4")
        server.send(Rays(component="lidar", payload=rays.tobytes()))
        assert np.frombuffer(two.expect("rays", component="lidar")["payload"], "<f4").tolist() == rays.tolist()
    wait_until(lambda: server.wishes.values == frozenset())


# control -------------------------------------------------------------------------------------------------


def test_events_of_the_driving_page_reach_the_simulation(served, patient) -> None:
    server, url = served
    with Client(url) as page:
        page.expect("welcome")
        page.send("pause")
        page.send("step", count=3)
        page.send("set_speed", factor=None)
        page.send("drag", node="box", anchor=[0, 0, 0], target=[1, 2, 3])
        wait_until(lambda: len(server._hub.events) == 4)
        events = server.take_events()
        assert events == [Pause(), Step(3), SetSpeed(None), Drag("box", (0.0, 0.0, 0.0), (1.0, 2.0, 3.0))]
    wait_until(lambda: not server.watched)
    assert server.take_events() == [DragEnd()]
    assert server.take_events() == []


def test_those_who_watch_are_refused(served) -> None:
    server, url = served
    with Client(url) as driver, Client(url) as other:
        driver.expect("seat", pages=2)
        other.send("pause")
        assert "another page drives" in other.expect("refused", what="pause")["why"]
        other.send("call_service", request=4, component="robot.motion", service="stop")
        answer = other.expect("answer", request=4)
        assert not answer["ok"]
        assert "another page drives" in answer["error"]
        other.send("keys", held=["ArrowUp"])
        other.send("hand_over", to=2)
        other.expect("refused", what="hand_over")
        assert server.held_keys() == frozenset()
        assert server.take_events() == []


def test_answers_go_to_the_page_that_asked_under_its_own_number(served) -> None:
    server, url = served
    with Client(url) as one, Client(url) as two:
        one.expect("seat", pages=2)
        one.send("call_service", request=1, component="a", service="s", arguments=[1, "x"])
        first = wait_until(server.take_events)[0]
        assert isinstance(first, CallService)
        assert (first.component, first.service, first.arguments) == ("a", "s", [1, "x"])
        one.send("hand_over", to=2)
        two.expect("seat", driver=2)
        two.send("call_service", request=1, component="b", service="s")
        second = next(e for e in wait_until(server.take_events) if isinstance(e, CallService))
        assert first.request != second.request
        two.send("cancel_service", request=1)
        assert wait_until(server.take_events)[-1].request == second.request
        server.send(Answer(second.request, ok=True, value="second"))
        server.send(Answer(first.request, ok=False, error="first"))
        server.send(Answer(first.request, ok=True, value="once more"))
        server.send(Log("info", "end"))
        assert two.expect("answer", request=1)["value"] == "second"
        assert one.expect("answer", request=1)["error"] == "first"
        one.expect("log")


def test_keys_are_held_until_released_hidden_or_gone(served, patient) -> None:
    server, url = served
    with Client(url) as page:
        page.expect("welcome")
        page.send("keys", held=["ArrowUp"])
        wait_until(lambda: server.held_keys() == {"ArrowUp"})
        page.send("keys", held=["ArrowUp", "ArrowLeft"])
        wait_until(lambda: server.held_keys() == {"ArrowUp", "ArrowLeft"})
        page.send("keys", held=[])
        wait_until(lambda: server.held_keys() == frozenset())
        page.send("keys", held=["ArrowUp"])
        wait_until(lambda: server.held_keys() == {"ArrowUp"})
    wait_until(lambda: server.held_keys() == frozenset())


def test_a_page_that_falls_silent_lets_go(served) -> None:
    server, url = served
    now = [0.0]
    server._hub.control_lock._clock = lambda: now[0]
    with Client(url) as page:
        page.expect("welcome")
        page.send("keys", held=["ArrowUp"])
        wait_until(lambda: server.held_keys() == {"ArrowUp"})
        page.send("drag", node="box", anchor=[0, 0, 0], target=[1, 2, 3])
        events: list[object] = []

        def over() -> bool:
            events.extend(server.take_events())
            return bool(events)

        wait_until(over)
        now[0] += 0.9 * DEAD_MAN
        over()
        assert server.held_keys() == {"ArrowUp"}
        now[0] += 0.2 * DEAD_MAN
        over()
        assert events == [Drag("box", (0.0, 0.0, 0.0), (1.0, 2.0, 3.0)), DragEnd()]
        assert server.held_keys() == frozenset()


def test_too_many_events_are_refused(served) -> None:
    server, url = served
    with Client(url) as page:
        page.expect("welcome")
        for _ in range(1100):
            page.send("pause")
        for _ in range(100):
            assert "busy" in page.expect("refused")["why"]
        assert len(server.take_events()) == 1000


def test_infinite_speed_and_unwatched_publish(served) -> None:
    server, _ = served
    server.set_scene(*one_box())
    server.publish(Snapshot(1, 0.0, 1, np.zeros((1, 7), np.float32), "running", math.inf))
    assert not server.watched
