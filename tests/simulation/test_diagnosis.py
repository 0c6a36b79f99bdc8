"""The reasons why a simulation cannot keep up."""

from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import pytest

from morse.core.observer import SHOWN, Observer
from morse.simulation.ticks.loop import TICKS, Diagnosis

BUDGET = 0.016


def diagnose(tick: float, share: float = 1.0, component: float = 0.0) -> str:
    """The diagnosis for ticks of a given duration, of a process with a given share of a processor.

    Args:
        component: seconds per tick of one component; the rest is distributed over the phases.
    """
    clock = SimpleNamespace(wall=0.0, processor=0.0)
    diagnosis = Diagnosis(None, lambda: clock.wall, lambda: clock.processor)
    profile = diagnosis.profile
    for _ in range(TICKS):
        assert not diagnosis.done
        profile.begin()
        phases = [cost for name, cost in profile.phases.items() if name != "sensors"]
        for phase in phases:
            phase.add((tick - component) / len(phases))
        profile.phases["sensors"].add(component)
        if component:
            profile.component("robot.eyes", 0.0, component)
        clock.wall += max(tick, BUDGET)
        clock.processor += share * max(tick, BUDGET)
    assert diagnosis.done
    return diagnosis.cause(BUDGET)


def test_a_component_that_takes_most_of_the_tick_is_named() -> None:
    assert diagnose(0.030, component=0.025) == (
        "most time goes to robot.eyes: 25.0 ms per tick of the 16.0 ms that it may take"
    )


def test_ticks_that_are_quick_enough_are_no_cause() -> None:
    assert diagnose(0.002, component=0.001) == (
        "the machine is busy with other work: a tick takes 2.0 ms of the 16.0 ms that it may take"
    )


def test_a_machine_that_is_shared_is_the_cause_whatever_the_tick_does() -> None:
    assert diagnose(0.030, share=0.4, component=0.025) == (
        "the machine is busy with other programs: MORSE gets 40 % of a processor"
    )


def test_where_nothing_stands_out_no_cause_is_named() -> None:
    assert diagnose(0.030) == ""


class Watcher(Observer):
    """Records the reported paces."""

    def __init__(self) -> None:
        self.told: list[tuple[float, str]] = []

    def report_pace(self, late: float, cause: str = "") -> None:
        self.told.append((late, cause))


@pytest.fixture
def slow(load: Callable[..., Any], monkeypatch: pytest.MonkeyPatch) -> Any:
    """A simulation that was reported as slow to the pages."""
    simulation = load("robot = ATRV()\nenv = Environment('empty', fastmode=True)")
    watcher = Watcher()
    simulation.observers.append(watcher)
    # each tick has lost five seconds until this is reported
    pacer = simulation.pacer
    monkeypatch.setattr(pacer, "wait", lambda: setattr(pacer, "lost", 0.0 if watcher.told else 5.0))
    simulation.run((TICKS + 3) / simulation.clock.frequency)
    ((late, _),) = watcher.told
    assert late == 5.0
    simulation.watcher = watcher
    return simulation


def test_pages_are_told_that_they_show_the_pace_elsewhere(slow: Any, caplog: pytest.LogCaptureFixture) -> None:
    (line,) = [record for record in caplog.get_records("setup") if "cannot keep up" in record.getMessage()]
    assert getattr(line, SHOWN) is True


def test_a_reset_takes_the_warning_back(slow: Any) -> None:
    slow.restart()
    assert slow.watcher.told[-1] == (0.0, "")


def test_a_simulation_that_keeps_up_again_takes_the_warning_back(slow: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(type(slow.pacer), "keeps_up", True)
    slow.run(2 / slow.clock.frequency)
    assert slow.watcher.told[-1] == (0.0, "")
    assert len(slow.watcher.told) == 2  # once
