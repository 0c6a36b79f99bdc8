"""A fault stays where it is: the part that raises is switched off and named; all others go on with the same data."""

from __future__ import annotations

import functools
import re
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

sys.path.insert(0, str(Path(__file__).parent))

import faulty_parts as parts
from faults import FAULTS, HUGE

import morse
from morse.builder import Environment, MotionVW, Pose
from morse.core.rows.marks import present_data
from morse.scene import StreamDeclaration

TICKS = 8
#: each kind of a part that may fail: its name in the log, and the consequence
KINDS = {
    "sensor": ("r0.gauge", "is deactivated"),
    "report": ("r0.gauge", "is deactivated"),
    "no data": ("r0.gauge", "is deactivated"),
    "action": ("r0.stubborn", "is deactivated"),
    "server": ("r0.asking", "is deactivated"),
    "request": ("r0.asking", "is deactivated"),
    "actuator": ("r0.motor", "is deactivated"),
    "robot": ("r0", "is deactivated"),
    "pose of robot": ("r0", "is deactivated"),
    "lazy": ("r0.team", "is deactivated"),
    "waiting": ("r0.team", "is deactivated"),
    "observing": ("r0.team", "is deactivated"),
    "modifier of a sensor": ("the modifier Shaky of r0.gauge", "r0.gauge is deactivated"),
    "modifier of an actuator": ("the modifier Shaky of r0.motor", "r0.motor is deactivated"),
    "stream": ("the stream Line of r0.pose", "is closed"),
    "stream of commands": ("the stream Line of r0.motion", "is closed"),
    "output function": ("of r0.pose", "is closed"),
    "manager action": ("the middleware faulty_parts.Cable", "is removed"),
    "manager flush": ("the middleware faulty_parts.Cable", "is removed"),
    "before_tick": ("the observer Watcher", "is removed"),
    "after_tick": ("the observer Watcher", "is removed"),
    "rearranged": ("the observer Watcher", "is removed"),
    "report_pace": ("the observer Watcher", "is removed"),
    "subscriber": ("the callback ", "is removed"),
    "push": ("the callback ", "is removed"),
    "review": ("the callback ", "is removed"),
    "sink": ("the callback ", "is removed"),
    "end of a service": ("the callback ", "is removed"),
    "service object": ("of the services of", "does not act any more"),
}


def _scene(count: int) -> Any:
    def describe() -> None:
        for number in range(count):
            robot = parts.Carriage(f"r{number}")
            robot.translate(3.0 * number, 0.0, 0.0)
            robot.append(MotionVW("motion"))
            robot.append(Pose("pose"))
            for cls in (parts.Gauge, parts.Stubborn, parts.Asking, parts.Team, parts.Motor):
                robot.append(cls(cls.__name__.lower()))
        Environment("empty", fastmode=True)

    return describe


@pytest.fixture(autouse=True)
def reset() -> Iterator[None]:
    yield
    parts.fault = list
    for cls in (parts.Gauge, parts.Motor, parts.Carriage, parts.Cable):
        cls.where = ""


class Run:
    """A simulation with one faulty part; ``data`` of all components, tick by tick."""

    def __init__(self, kind: str, count: int, *, on_failure: str = "deactivate") -> None:
        for cls in (parts.Gauge, parts.Motor, parts.Carriage, parts.Cable):
            cls.where = kind
        self.kind = kind
        self.data: list[dict[str, Any]] = []
        self.calls = 0
        self.simulation = morse.load(_scene(count), on_failure=on_failure)
        context = self.simulation.context
        self.manager = parts.Cable({}, context)
        context.stream_managers["faulty_parts.Cable"] = self.manager
        self.simulation.observers.insert(0, self.manager)
        self.sent: dict[str, list[int]] = {}
        for name in list(context.components):
            if name.endswith("team"):  # a stream that does not tell whether somebody reads it reads in each tick
                continue
            for number, fails in enumerate((True, False)):
                direction = "IN" if name.rpartition(".")[2] in ("motion", "motor") else "OUT"
                meant = {"stream": "r0.pose", "stream of commands": "r0.motion"}.get(kind)
                options = {"fails": fails and name == meant, "sent": self.sent.setdefault(f"{name} {number}", [])}
                self.manager.connect(context.components[name], StreamDeclaration("cable", "line", direction, options))
        self._attach()

    def _fail(self, *_arguments: Any) -> int:
        if self.simulation.ticks >= parts.TICK:
            self.calls += 1
            parts.fault()
        return self.simulation.ticks + 1

    def _attach(self) -> None:
        simulation, kind = self.simulation, self.kind
        component = simulation.context.components
        if kind == "modifier of a sensor":
            component["r0.gauge"].output_modifiers.append(parts.Shaky(component["r0.gauge"], {}))
        elif kind == "modifier of an actuator":
            component["r0.motor"].input_modifiers.append(parts.Shaky(component["r0.motor"], {}))
        elif kind == "output function":
            component["r0.pose"].output_functions.append(self._fail)
        elif kind in ("before_tick", "after_tick", "rearranged", "report_pace"):
            simulation.observers.append(parts.Watcher(simulation, kind))
        elif kind == "subscriber":
            simulation.r0.pose.subscribe(self._fail)
        elif kind == "push":
            simulation.before_physics.append(self._fail)
        elif kind == "review":
            simulation.reviews.append(self._fail)
        elif kind == "sink":
            simulation.journal.sinks.append(self._fail)
        elif kind == "end of a service":
            simulation.call("time", "sleep", 4 / 60).add_done_callback(self._fail)
        elif kind == "service object":
            self.server = _Server(self._fail)
            simulation.context.service_objects.append(self.server)

    def go(self) -> Run:
        for tick in range(TICKS):
            if self.kind == "waiting" and tick == parts.TICK:
                self.simulation.schedule()
            if self.kind == "rearranged" and tick == parts.TICK:
                self.simulation.context.guard.tell(self.simulation.observers, lambda one: one.rearranged())
            if self.kind == "report_pace" and tick == parts.TICK:
                self.simulation._loop._slow = True
                self.simulation._loop.restarted()
            for number in range(len(self.simulation.robots)):
                self.simulation[f"r{number}"].motion.publish({"v": 0.1 * tick, "w": 0.2})
            self.simulation.step()
            components = self.simulation.context.components.items()
            self.data.append({name: dict(data) for name, c in components if (data := present_data(c)) is not None})
        return self

    def __enter__(self) -> Run:
        return self

    def __exit__(self, *_: object) -> None:
        self.simulation.close()


class _Server:
    is_idle = False

    def __init__(self, action: Any) -> None:
        self.action = action

    def name(self) -> str:
        return "gate"

    def get_state(self) -> None:
        return None

    def services(self) -> list[Any]:
        return []

    def finalize(self) -> None: ...


@functools.cache
def _undisturbed(count: int) -> tuple[list[dict[str, Any]], dict[str, list[int]]]:
    fault, parts.fault = parts.fault, list
    try:
        with Run("nothing", count) as run:
            return run.go().data, run.sent
    finally:
        parts.fault = fault


def _check(kind: str, count: int, error: str, caplog: pytest.LogCaptureFixture) -> None:
    parts.fault = FAULTS[error]
    who, consequence = KINDS[kind]
    with Run(kind, count) as run:
        data = run.go().data
        assert run.simulation.ticks == TICKS
        assert run.calls <= 1, "it is switched off"
        lines = [r.getMessage() for r in caplog.records if r.levelname == "ERROR" and " failed and " in r.getMessage()]
        (line,) = [one for one in lines if who in one and consequence in one]
        assert "faults.py" in line or "faulty_parts.py" in line or "test_faults_stay.py" in line
        assert ", line " in line
        assert len(line) < HUGE // 100
        off = who.rpartition(" ")[2] if "is deactivated" in consequence else None
        assert run.simulation.context.failed == ({off} if off else set())
        (failure,) = [one for one in run.simulation.failures if who in one.part and consequence in one.consequence]
        assert failure.kind == "fault"
        assert failure.time == pytest.approx(parts.TICK / 60, abs=1.01 / 60)
        assert re.search(r"(faults|faulty_parts|test_faults_stay)\.py:\d+$", failure.where), failure
    assert failure in run.simulation.failures, "also after the end"
    expected, sent = _undisturbed(count)
    for then, now in zip(expected, data, strict=True):
        for name, values in then.items():
            if name != off and not (off == "r0" and name.startswith("r0.")):
                assert now[name] == values, name
    hit = {"stream": "r0.pose 0", "stream of commands": "r0.motion 0"}.get(kind, off)
    if not kind.startswith("manager"):
        for name, ticks in sent.items():
            if hit is None or not name.startswith(hit):
                assert run.sent[name] == ticks, name
    if f"{off} 1" in run.sent:
        assert len(run.sent[f"{off} 1"]) <= parts.TICK + 1, "it sends nothing more"


@pytest.mark.parametrize("count", [1, 4])
@pytest.mark.parametrize("kind", KINDS)
def test_every_part_that_fails_is_switched_off_alone(kind: str, count: int, caplog: pytest.LogCaptureFixture) -> None:
    _check(kind, count, "ValueError", caplog)


@pytest.mark.parametrize("error", FAULTS)
@pytest.mark.parametrize("kind", ["sensor", "modifier of a sensor", "stream", "after_tick", "subscriber"])
def test_every_error_is_named(kind: str, error: str, caplog: pytest.LogCaptureFixture) -> None:
    _check(kind, 1, error, caplog)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("error", ["Strange", "MuteBase", "GeneratorExit", "Endless"])
def test_errors_that_nobody_catches_in_groups(kind: str, error: str, caplog: pytest.LogCaptureFixture) -> None:
    _check(kind, 4, error, caplog)


@pytest.mark.parametrize("end", [KeyboardInterrupt, SystemExit])
def test_what_ends_the_program_is_no_fault_of_a_component(end: type[BaseException], caplog: Any) -> None:
    """The log named its attributes as mistakes."""
    with morse.load(_scene(1)) as simulation:
        guard = simulation.context.guard
        guard.remarks = lambda _: ["rename it"]
        with pytest.raises(end):
            guard.deactivate(simulation.context.components["r0.pose"], end())
        assert not simulation.context.failed
    assert "rename it" not in caplog.text
