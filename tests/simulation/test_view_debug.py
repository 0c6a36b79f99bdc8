"""Properties that are shown while the simulation runs."""

import time
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import pytest

from morse.viewer.feeds.components import ViewDebug
from morse.viewer.view_messages import DebugProperties

SCENE = """
from morse.builder.creator import SensorCreator

class Writer(SensorCreator):
    _classpath = "view_parts.Writer"

robot = ATRV()
writer, pose = Writer(), Pose()
robot.append(writer)
robot.append(pose)
robot.properties(Label="a robot", Speed=2.0)
env = Environment("empty", fastmode=True)
"""


class Shown:
    """The displayed properties of a simulation, on request."""

    def __init__(self, simulation: Any, monkeypatch: pytest.MonkeyPatch) -> None:
        self.said: list[DebugProperties] = []
        self._now = time.monotonic()
        monkeypatch.setattr("morse.viewer.feeds.components.time.monotonic", lambda: self._now)
        self._debug = ViewDebug(simulation, SimpleNamespace(send=self.said.append))  # type: ignore[arg-type]

    def look(self, after: float = 0.25) -> dict[str, str]:
        """The properties, after some wall-clock time."""
        self._now += after
        self._debug.update()
        return {f"{p.node}.{p.name}": p.value for p in self.said[-1].properties} if self.said else {}


@pytest.fixture
def show(load: Callable[..., Any], monkeypatch: pytest.MonkeyPatch) -> Callable[[str], tuple[Any, Shown]]:
    def start(more: str) -> tuple[Any, Shown]:
        simulation = load(SCENE + more)
        return simulation, Shown(simulation, monkeypatch)

    return start


def test_nothing_is_shown_unless_the_script_asks(show: Any) -> None:
    simulation, shown = show("")
    simulation.tick()
    assert shown.look() == {}
    assert shown.said == []


def test_what_gets_a_value_while_running_is_shown(show: Any) -> None:
    simulation, shown = show("env.show_debug_properties()")
    assert shown.look() == {}
    simulation.tick()
    seen = shown.look()
    assert seen["robot.ticks"] == "1"
    assert seen["robot.long"].startswith("[0, 1, 2")
    assert seen["robot.text"] == "x" * 200
    assert "Broken" in seen["robot.broken"]
    assert "robot.Label" not in seen
    assert max(map(len, seen.values())) <= 200
    simulation.tick()
    assert shown.look()["robot.ticks"] == "2"
    told = len(shown.said)
    shown.look()
    assert len(shown.said) == told  # nothing has changed
    simulation.restart()
    assert shown.look() == {}


def test_marked_properties_are_shown_from_the_start(show: Any) -> None:
    _, shown = show("robot.scene_node.debug = ('Label',)\nenv.show_debug_properties()")
    assert shown.look() == {"robot.Label": "a robot"}


def test_of_very_many_only_the_first_are_shown(show: Any) -> None:
    simulation, shown = show("env.show_debug_properties()")
    robot = simulation.context.world.objects_by_name["robot"]
    for i in range(250):
        robot[f"p{i}"] = i
    assert len(shown.look()) == 100
    assert shown.said[-1].more == 150


def test_profiled_sensors_show_their_share_of_the_time(show: Any) -> None:
    simulation, shown = show("writer.profile()")
    assert shown.look() == {}
    begin = time.perf_counter()
    for _ in range(20):
        simulation.tick()
    most = time.perf_counter() - begin
    seen = shown.look(after=1.0)
    assert list(seen) == ["robot.writer.profile"]  # neither properties nor the other sensor were requested
    # 20 actions of at least 2 ms in one second of the clock
    assert 4.0 <= float(seen["robot.writer.profile"].removesuffix(" %")) <= 100.0 * most
    assert shown.look(after=1.0)["robot.writer.profile"] == "0.0 %"
