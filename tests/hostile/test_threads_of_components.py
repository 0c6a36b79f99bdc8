"""An error in a thread of a component is reported like any other error of the component."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Any

import pytest

import morse
from morse.builder import Environment
from morse.core.sensor import Sensor
from morse.helpers.components import add_data
from morse.robots.fakerobot import FakeRobot


class Radar(Sensor):
    """It measures in a thread."""

    add_data("count", 0, "int", "Number of measurements")
    start: Callable[[Radar], threading.Thread]

    def __init__(self, obj: Any, parent: Any = None) -> None:
        super().__init__(obj, parent)
        self.thread = type(self).start(self)
        self.thread.start()

    def listen(self) -> None:
        raise ValueError("no echo")

    def default_action(self) -> None:
        self.local_data["count"] += 1


def _scene() -> None:
    FakeRobot("robot").append(Radar("radar"))
    Environment("empty", fastmode=True)


STARTS: dict[str, Callable[[Radar], threading.Thread]] = {
    "method": lambda radar: threading.Thread(target=radar.listen, name="ears"),
    "timer": lambda radar: threading.Timer(0.0, radar.listen),
    "argument": lambda radar: threading.Thread(target=lambda one: one.listen(), args=(radar,)),
    "closure": lambda radar: threading.Thread(target=lambda: radar.listen()),
}


@pytest.mark.parametrize("start", STARTS)
def test_it_is_named_in_the_log(
    start: str, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(Radar, "start", staticmethod(STARTS[start]), raising=False)
    with morse.load(_scene) as simulation:
        radar = simulation.context.components["robot.radar"]
        radar.thread.join(60.0)
        simulation.step(3)
        assert radar.local_data["count"] == 3, "the component itself goes on"
    (text,) = [one for one in caplog.messages if "thread" in one]
    assert text.startswith(f"[ERROR][MORSE] the thread {radar.thread.name} of robot.radar failed and has ended: ")
    assert "ValueError: no echo" in text
    assert f'{__file__}", line' in text
    assert "Traceback" not in capfd.readouterr().err


def test_a_program_may_ask_for_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Radar, "start", staticmethod(STARTS["method"]), raising=False)
    with morse.load(_scene, on_failure="raise") as simulation:
        simulation.context.components["robot.radar"].thread.join(60.0)
        with pytest.raises(ValueError, match="no echo"):
            simulation.step()


def test_other_threads_are_reported_as_before(monkeypatch: pytest.MonkeyPatch) -> None:
    failures: list[str] = []
    monkeypatch.setattr(threading, "excepthook", lambda failure: failures.append(str(failure.exc_value)))

    def fail() -> None:
        raise ValueError("of the program")

    with morse.load(lambda: Environment("empty", fastmode=True)):
        other = threading.Thread(target=fail)
        other.start()
        other.join(60.0)
    assert failures == ["of the program"]
