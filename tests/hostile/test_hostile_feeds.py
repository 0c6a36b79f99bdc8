"""Components whose data or state cannot be read do not end the live view, which shows all others."""

import logging
from types import SimpleNamespace
from typing import Any

import hostile_objects as objects
import pytest

import morse
from morse.builder import Environment, FakeRobot, Pose
from morse.core.state import StateError
from morse.viewer.feeds.components import ValuesFeed
from morse.viewer.page_inputs import Rewinder

BAD_DATA = {
    "nothing": lambda: None,
    "a list": lambda: [1.0],
    "an object without attributes": objects.Mute,
    "a field without attributes": lambda: {"a": objects.Mute()},
    "a disguised field": lambda: {"a": objects.Disguised()},
    "items that cannot be read": objects.Unordered,
}


def _scene() -> None:
    robot = FakeRobot("robot")
    robot.append(Pose("bad"))
    robot.append(Pose("good"))
    Environment("empty", fastmode=True)


@pytest.mark.parametrize("data", BAD_DATA)
def test_data_that_cannot_be_read_are_not_shown_and_others_are(data: str) -> None:
    sent: list[Any] = []
    server: Any = SimpleNamespace(wishes=SimpleNamespace(values={"robot.bad", "robot.good"}), send=sent.append)
    with morse.load(_scene) as simulation:
        simulation.step()
        simulation.context.components["robot.bad"].local_data = BAD_DATA[data]()
        ValuesFeed(simulation.context, server).update()
        bad, good = sent
        assert bad.component == "robot.bad"
        assert good.data == dict(simulation.robot.good.data)


def test_a_state_that_cannot_be_saved_is_named_once(caplog: pytest.LogCaptureFixture) -> None:
    def save() -> Any:
        raise StateError("robot.bad cannot be saved")

    seconds = iter(range(100))
    server: Any = SimpleNamespace(send=lambda _: None)
    rewinder = Rewinder(SimpleNamespace(save=save), lambda: float(next(seconds)), server)  # type: ignore[arg-type]
    with caplog.at_level(logging.WARNING):
        for paused in (False, True, False, True):
            rewinder.keep(paused=paused)
        rewinder.rewind(0.0)
        rewinder.step_back()
    assert [r.getMessage() for r in caplog.records if "robot.bad cannot be saved" in r.getMessage()]
    assert len(caplog.records) == 1
