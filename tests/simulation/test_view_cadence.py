"""The update rates of the live view, with a clock that the test controls."""

import math
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from morse.simulation.simulation import Simulation
from morse.viewer.hub import Wishes
from morse.viewer.live_view import View
from morse.viewer.snapshot import Snapshot
from morse.viewer.view_messages import Rays

SCENE = """
robot = ATRV()
laser = Hokuyo("laser")
robot.append(laser)
env = Environment("empty", fastmode=True)
"""


class Server:
    """Records the data for pages."""

    watched = True
    wishes = Wishes(overlays=frozenset({"robot.laser"}))

    def __init__(self, *_: Any, **__: Any) -> None:
        self.shown: list[Snapshot] = []
        self.said: list[Any] = []
        self.publish = self.shown.append
        self.send = self.said.append

    def start(self) -> str:
        return "http://127.0.0.1/"

    def stop(self) -> None:
        """No connection."""

    def set_scene(self, *_: Any) -> None:
        """No page."""

    def take_events(self) -> list[Any]:
        return []

    def held_keys(self) -> frozenset[str]:
        return frozenset()

    def gamepad(self) -> tuple[tuple[float, ...], tuple[bool, ...]]:
        return (), ()


class Watched:
    """A simulation with a page, and the wall clock of its view."""

    def __init__(self, simulation: Simulation, monkeypatch: pytest.MonkeyPatch) -> None:
        self.now = time.monotonic()
        monkeypatch.setattr("morse.viewer.live_view.ViewServer", Server)
        monkeypatch.setattr("morse.viewer.live_view.time.monotonic", lambda: self.now)
        self.simulation = simulation
        simulation.view = view = View(simulation)
        simulation.observers.append(view)
        view.announce()
        self.server: Server = view._server  # type: ignore[assignment]

    def run(self, seconds: float, each: float = 0.0005) -> int:
        """Ticks of a given duration; returns the number of snapshots."""
        before = len(self.server.shown)
        for _ in range(round(seconds / each)):
            self.now += each
            self.simulation.tick()
        return len(self.server.shown) - before


@pytest.fixture
def watched(load: Callable[..., Any], monkeypatch: pytest.MonkeyPatch) -> Watched:
    return Watched(load(SCENE), monkeypatch)


@pytest.mark.parametrize(("speed", "rate"), [(math.inf, 20), (100.0, 125)])
def test_a_quick_simulation_is_shown_as_often_as_eyes_can_see_it(watched: Watched, speed: float, rate: int) -> None:
    watched.simulation.pacer.set_speed(speed)
    assert 0.9 * rate <= watched.run(1.0) <= rate + 1
    assert watched.server.shown[-1].speed == speed


@pytest.mark.parametrize("speed", [math.inf, 1.0])
def test_every_tick_is_shown_of_a_simulation_that_is_no_quicker(watched: Watched, speed: float) -> None:
    watched.simulation.pacer.set_speed(speed)
    assert watched.run(1.0, each=1 / 50) == 50
    assert [shown.tick for shown in watched.server.shown] == list(range(1, 51))


def test_rays_are_shown_of_the_sensors_that_there_are(watched: Watched) -> None:
    for _ in range(2):
        watched.run(0.5, each=1 / 60)
        rays = [message for message in watched.server.said if isinstance(message, Rays)]
        assert {message.component for message in rays} == {"robot.laser"}
        assert len(rays) >= 3  # of ten scans a second
        watched.simulation.restart()
        watched.server.said.clear()


def test_sensors_of_which_no_page_shows_data_measure_when_they_are_read(
    load: Callable[..., Any], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    poses = 'for number in range(3):\n    robot = ATRV(f"robot{number}")\n    robot.append(Pose("pose"))\n'
    watched = Watched(load(poses + 'env = Environment("empty", fastmode=True)\n'), monkeypatch)
    with watched.simulation.record(tmp_path / "run.mcap"):
        watched.run(0.1)
    sensors = [watched.simulation.context.components[f"robot{number}.pose"] for number in range(3)]
    # the first access to the data creates the attribute
    assert not any("local_data" in vars(sensor) for sensor in sensors)
