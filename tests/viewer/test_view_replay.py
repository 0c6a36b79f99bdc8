"""A recorded run on the page: jump, drag, play, backward; it cannot be changed."""

import contextlib
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from view_pages import Client

import morse
from morse.launch.playing import playing
from morse.recording.recording import Recording
from morse.viewer.replay_view import ReplayView
from tests.kit.waiting import wait_until

SCENE = """
from morse.builder import *

robot = ATRV()
motion, pose = MotionVW(), Pose()
robot.append(motion)
robot.append(pose)
robot.add_default_interface("socket")
Environment("empty")
"""
TICKS = 120


@pytest.fixture
def truth(tmp_path: Path) -> list[float]:
    """The position of the robot along X after each tick of the recorded run, m."""
    script = tmp_path / "scene.py"
    script.write_text(SCENE)
    with morse.load(script) as sim, sim.record(tmp_path / "run.mcap"):
        found = [sim.robot.pose.data["x"]]
        sim.robot.motion.publish({"v": 1.0})
        for _ in range(TICKS):
            sim.step()
            found.append(sim.robot.pose.data["x"])
    return found


@pytest.fixture
def view(truth: list[float], tmp_path: Path) -> Iterator[ReplayView]:
    with Recording(tmp_path / "run.mcap") as recording, playing(recording, port=0, browser=False) as shown:
        shown.announce()
        yield shown


@pytest.fixture
def client(view: ReplayView) -> Iterator[Client]:
    with Client(view.url, close_timeout=0.2) as one:
        turn_until(view, lambda: view._server.watched)
        yield one


def turn_until(view: ReplayView, condition: Callable[[], Any]) -> None:
    end = time.monotonic() + 60.0
    while time.monotonic() < end:
        view.turn()
        if condition():
            return
    raise AssertionError("it never happens")


def shown_time(client: Client) -> float:
    """Time of the last frame that was sent to the page, s; the page confirms it."""
    with contextlib.suppress(TimeoutError):
        client.receive(timeout=0.05)
    client.send("taken", count=len(client.poses))
    return float(client.poses[-1][5]) if client.poses else -1.0


def where(view: ReplayView) -> float:
    return float(view._simulation.world.game_object("robot").worldPosition.x)


def test_the_time_line_is_that_of_the_whole_run(view: ReplayView, client: Client) -> None:
    history = client.expect("history")
    assert history["recorded"]
    assert (history["times"][0], history["times"][-1]) == pytest.approx((0.0, TICKS / 60))
    assert len(history["times"]) == TICKS + 1


def test_jumps_go_where_the_page_wants_in_both_directions(view: ReplayView, client: Client, truth: list[float]) -> None:
    client.send("pause")
    for target in (100, 20, 21, 120, 1):
        client.send("rewind", time=target / 60)
        turn_until(view, lambda target=target: view._timeline.position == target and view._target is None)  # type: ignore[misc]
        assert where(view) == truth[target]
        turn_until(view, lambda target=target: shown_time(client) == pytest.approx(target / 60))  # type: ignore[misc]
    client.send("step", count=2)
    turn_until(view, lambda: view._timeline.position == 3)
    client.send("step_back")
    turn_until(view, lambda: view._timeline.position == 2)
    assert where(view) == truth[2]


def test_it_plays_to_the_end_backward_to_the_beginning_and_forward_again(
    view: ReplayView, client: Client, truth: list[float]
) -> None:
    client.send("set_speed", factor=20.0)
    turn_until(view, lambda: view._timeline.position == TICKS)
    assert where(view) == truth[TICKS]
    client.send("play_backward")
    seen: list[int] = []
    turn_until(view, lambda: seen.append(view._timeline.position) or view._timeline.position == 0)  # type: ignore[func-returns-value]
    assert seen == sorted(seen, reverse=True)
    assert len(set(seen)) > 2
    client.send("play")
    turn_until(view, lambda: view._timeline.position > 30)


def test_a_recorded_run_takes_no_commands(view: ReplayView, client: Client, truth: list[float]) -> None:
    client.send("pause")
    client.send("keys", held=["ArrowUp"])
    client.send("command", request=1, component="robot.motion", fields={"v": -5.0})
    client.send("call_service", request=2, component="robot.motion", service="stop", arguments=[])
    client.send("teleport", request=3, node="robot", position=[9, 9, 9], quaternion=[1, 0, 0, 0])
    client.send("rewind", time=60 / 60)
    turn_until(view, lambda: view._timeline.position == 60 and view._target is None)
    assert where(view) == truth[60]
    refusals: list[str] = []

    def refused() -> bool:
        with contextlib.suppress(TimeoutError):
            client.receive(timeout=0.02)
        refusals[:] = [message["why"] for message in client.messages if message["type"] == "refused"]
        return bool(refusals)

    turn_until(view, refused)
    assert "recorded run" in refusals[0]


def test_the_page_ends_it(view: ReplayView, client: Client) -> None:
    client.send("quit")
    view.run()  # returns


def test_no_socket_of_the_scene_is_opened(view: ReplayView) -> None:
    assert view._simulation.context.stream_managers == {}
    assert view._simulation.context.services.request_managers() == {}


@pytest.mark.browser
def test_the_time_line_of_a_real_page(view: ReplayView, open_page: Callable[..., Any], truth: list[float]) -> None:
    playing_ = threading.Thread(target=view.run)
    playing_.start()
    try:
        page = open_page(view.url)
        slider = page.get_by_label("go back in time")
        wait_until(slider.is_visible, "a time line")
        wait_until(lambda: view._timeline.position == TICKS, "the end of the run", limit=60.0)
        slider.focus()
        slider.press("Home")
        wait_until(lambda: view._timeline.position == 0, "a jump to the beginning")
        slider.fill("90")
        wait_until(lambda: view._timeline.position == 90, "a jump ahead")
        label = page.get_by_label("time that is gone back to")
        wait_until(lambda: label.inner_text() == "0:01.50 / 0:02.00", "the time of the picture")
        page.get_by_role("button", name="Play backward").click()
        wait_until(lambda: view._timeline.position == 0, "the beginning of the run")
        assert slider.is_visible()
    finally:
        view.end()
        playing_.join()
