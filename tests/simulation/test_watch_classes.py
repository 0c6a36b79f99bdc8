"""The file of a component is saved while the simulation runs."""

import json
import os
import select
import socket
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from watched import Project

from morse.core.journal import EDIT
from morse.core.state import StateError
from morse.simulation.simulation import Simulation
from morse.simulation.watching.classes import to_renew
from morse.simulation.watching.edits import SavedFiles
from tests.kit.waiting import step_until

COUNTER = """
    from morse.core.sensor import Sensor
    from morse.core.declarations import add_data, add_property
    from morse.core.services import service, async_service
    from morse.core import status

    class Counter(Sensor):
        _name = "Counter"
        _short_desc = "Counts"
        add_data("count", 0, "int", "How often it has acted")
        add_property("_by", {by}, "By", "int", "What a tick adds")
        {more}

        def __init__(self, obj, parent=None):
            super().__init__(obj, parent)
            self.total = 0

        @service
        def version(self):
            return {by}

        @async_service
        def wait(self):
            pass

        def default_action(self):
            self.total += self._by
            self.local_data["count"] = self.total
"""
SCENE = """
    from proj.sensors.counter import Counter
    robot = ATRV()
    counter = Counter()
    robot.append(counter)
    counter.alter("", classpath="proj.modifiers.double.Double")
    counter.add_stream("socket")
    counter.add_service("socket")
    env = Environment("empty", fastmode=True)
"""
DOUBLE = """
    from morse.core.modifier import AbstractModifier

    class Double(AbstractModifier):
        def __init__(self, component, kwargs):
            super().__init__(component, kwargs)
            self.seen = 0

        def modify(self):
            self.seen += 1
            self.data["doubled"] = {factor} * self.data["count"]
            self.data["seen"] = self.seen
"""


@pytest.fixture
def project(tmp_path: Path) -> Project:
    made = Project(tmp_path)
    for name in ("proj/__init__.py", "proj/sensors/__init__.py", "proj/modifiers/__init__.py"):
        made.module(name, "")
    made.module("proj/sensors/counter.py", COUNTER.format(by=1, more=""))
    made.module("proj/modifiers/double.py", DOUBLE.format(factor=2))
    return made


@pytest.fixture
def run(project: Project, monkeypatch: pytest.MonkeyPatch) -> Iterator[Simulation]:
    monkeypatch.setenv("MORSE_SOCKET_PORT", "0")
    with project.load(SCENE, sockets=True) as simulation:
        yield simulation


def edited(run: Simulation, project: Project, **parts: Any) -> None:
    """Save the counter, and wait until the simulation has reloaded it."""
    before = run.context.components["robot.counter"]
    project.module("proj/sensors/counter.py", COUNTER.format(**{"by": 1, "more": "", **parts}))
    step_until(run, lambda: run.context.components["robot.counter"] is not before)


def refused(run: Simulation, caplog: pytest.LogCaptureFixture) -> str:
    """Wait until the simulation has refused the saved file, and return the reason."""

    def reasons() -> list[str]:
        return [record.getMessage() for record in caplog.records if record.levelname == "ERROR"]

    step_until(run, reasons)
    return "\n".join(reasons())


def test_the_class_is_exchanged_and_its_state_stays(run: Simulation, project: Project) -> None:
    run.step(10)
    old = run.context.components["robot.counter"]
    edited(run, project, by=5)
    new = run.context.components["robot.counter"]
    assert type(new) is not type(old)
    assert type(new).__qualname__ == "Counter"
    total = new.total  # includes the last action of the old class and the first of the new one
    assert total > 10
    run.step(2)
    assert run.robot.counter.data["count"] == total + 10
    assert run.robot.counter.version().result() == 5
    assert new in run.loaded.sensors
    assert old not in run.loaded.sensors


def test_what_a_property_is_by_default_is_taken_unless_it_was_set(run: Simulation, project: Project) -> None:
    run.robot.counter.set_property("By", 7).result()
    edited(run, project, by=5)
    assert run.context.components["robot.counter"]._by == 7  # type: ignore[attr-defined]


def test_a_new_field_of_the_data_is_there(run: Simulation, project: Project) -> None:
    run.step(3)
    edited(run, project, more='add_data("colour", "red", "string", "New")')
    assert run.robot.counter.data["colour"] == "red"
    assert run.robot.counter.data["count"] >= 3
    edited(run, project)
    assert "colour" not in run.robot.counter.data


def test_who_listens_hears_the_new_class_and_nothing_twice(run: Simulation, project: Project) -> None:
    heard: list[int] = []
    run.robot.counter.subscribe(lambda data: heard.append(data["count"]))
    run.step(3)
    edited(run, project)
    run.step(3)
    assert heard == list(range(1, run.ticks + 1))


def test_a_client_stays_connected(run: Simulation, project: Project) -> None:
    (manager,) = run.context.services.request_managers().values()
    _, (_, port) = manager.on_incoming_request("simulation", "get_stream_port", ["robot.counter"])
    with socket.create_connection(("127.0.0.1", port), timeout=60) as connection:
        lines = connection.makefile("rb")
        step_until(run, lambda: select.select([connection], [], [], 0.0)[0])
        edited(run, project, by=1000)
        goal = run.robot.counter.data["count"] + 1000
        counts: list[int] = []

        def read() -> bool:
            while select.select([connection], [], [], 0.0)[0]:
                counts.append(json.loads(lines.readline())["count"])
            return bool(counts) and counts[-1] >= goal

        step_until(run, read)
        assert counts == sorted(counts)


def test_a_service_that_goes_on_goes_on(run: Simulation, project: Project) -> None:
    from pymorse import MorseServicePreempted

    future = run.robot.counter.wait()
    edited(run, project)
    assert future.running()
    future.cancel()
    with pytest.raises(MorseServicePreempted):
        future.result()


def test_a_modifier_is_exchanged_too(run: Simulation, project: Project) -> None:
    run.step(5)
    component = run.context.components["robot.counter"]
    before = component.output_modifiers[0]
    project.module("proj/modifiers/double.py", DOUBLE.format(factor=100))
    step_until(run, lambda: component.output_modifiers[0] is not before)
    run.step()
    data = run.robot.counter.data
    assert data["doubled"] == 100 * data["count"]
    assert data["seen"] == run.ticks
    assert run.context.components["robot.counter"] is component


def test_a_modifier_stays_when_its_component_is_exchanged(run: Simulation, project: Project) -> None:
    edited(run, project)
    run.step()
    data = run.robot.counter.data
    assert data["doubled"] == 2 * data["count"]
    assert data["seen"] == run.ticks


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("class Counter(:\n", "SyntaxError"),
        ("from morse.core.sensor import Sensr\n", "Sensr"),
        ("class Counter(Sensor):\n    pass\n", "NameError: name 'Sensor'"),
        ("from morse.core.sensor import Sensor\n\nclass Count(Sensor):\n    pass\n", "no class 'Counter'"),
        (COUNTER.format(by=1, more="").replace("self.total = 0", "self.total = 1 / 0"), "ZeroDivisionError"),
        ("import sys\nsys.exit(3)\n", "SystemExit"),
        ("\0", "null bytes"),
    ],
)
def test_a_file_with_a_mistake_is_refused_and_the_old_class_goes_on(
    run: Simulation, project: Project, caplog: pytest.LogCaptureFixture, text: str, reason: str
) -> None:
    run.step(3)
    before = run.context.components["robot.counter"]
    path = project.module("proj/sensors/counter.py", text)
    said = refused(run, caplog)
    assert reason in said
    assert str(path) in said
    assert run.context.components["robot.counter"] is before
    run.step(2)
    assert run.robot.counter.data["count"] == run.ticks
    caplog.clear()
    edited(run, project, by=3)  # the error is corrected
    assert run.robot.counter.version().result() == 3


def test_the_line_of_the_mistake_is_named(run: Simulation, project: Project, caplog: pytest.LogCaptureFixture) -> None:
    path = project.module("proj/sensors/counter.py", "import math\n\nx = = 3\n")
    assert f'File "{path}", line 3' in refused(run, caplog)


def test_a_component_that_failed_acts_again_once_it_is_mended(
    run: Simulation, project: Project, caplog: pytest.LogCaptureFixture
) -> None:
    text = COUNTER.format(by=1, more="").replace("self.total += self._by", "self.total += self.nothing")
    before = run.context.components["robot.counter"]
    project.module("proj/sensors/counter.py", text)
    step_until(run, lambda: run.context.components["robot.counter"] is not before)
    step_until(run, lambda: not run.context.components["robot.counter"].active)
    edited(run, project)
    assert run.context.components["robot.counter"].active


def test_one_that_was_deactivated_stays_so(run: Simulation, project: Project) -> None:
    run.deactivate("robot.counter")
    edited(run, project)
    assert not run.context.components["robot.counter"].active


def test_start_anew_runs_the_class_that_was_saved(run: Simulation, project: Project) -> None:
    edited(run, project, by=4)
    run.restart()
    run.step(2)
    assert run.robot.counter.data["count"] == 8


def test_a_recording_during_which_a_file_was_edited_says_so(run: Simulation, project: Project) -> None:
    with run.record_inputs() as recording:
        edited(run, project, by=2)
    (entry,) = [entry for entry in recording.entries if entry.kind == EDIT]
    assert entry.name.endswith("counter.py")
    with pytest.raises(StateError, match=r"counter\.py' was edited"):
        run.replay(recording)


def test_nothing_is_watched_unless_asked_for(project: Project) -> None:
    with project.load(SCENE, watch=False) as simulation:
        assert simulation.observers == []


def test_the_modules_of_the_project_stay_known(run: Simulation, project: Project) -> None:
    names = set(run.scene.project.sources())  # type: ignore[attr-defined]
    edited(run, project, by=2)
    assert set(run.scene.project.sources()) == names  # type: ignore[attr-defined]


# -- detection of saved files ----------------------------------------------------------------------


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "model.blend"
    path.write_text("old")
    return path


def test_a_file_that_is_saved_is_named_once(file: Path) -> None:
    files = SavedFiles()
    assert files.look([str(file)]) == []
    file.write_text("newer")
    looks = [files.look([str(file)]) for _ in range(4)]
    assert looks == [[], [str(file)], [], []]


def test_a_file_that_is_being_written_is_left_alone(file: Path) -> None:
    files = SavedFiles()
    files.look([str(file)])
    for length in range(10, 15):
        file.write_text("x" * length)
        assert files.look([str(file)]) == []
    assert files.look([str(file)]) == [str(file)]


def test_a_file_that_is_away_for_a_while_is_named_when_it_is_back(file: Path) -> None:
    files = SavedFiles()
    files.look([str(file)])
    file.unlink()
    assert files.look([str(file)]) == files.look([str(file)]) == []
    file.write_text("another")
    assert files.look([str(file)]) == []
    assert files.look([str(file)]) == [str(file)]


def test_a_file_of_the_same_size_and_time_that_takes_the_place_is_another(file: Path) -> None:
    files = SavedFiles()
    files.look([str(file)])
    before = file.stat()
    other = file.with_name("other")
    other.write_text("new")
    os.utime(other, ns=(before.st_atime_ns, before.st_mtime_ns))
    os.replace(other, file)
    assert files.look([str(file)]) == []
    assert files.look([str(file)]) == [str(file)]


def test_a_file_that_never_was_is_no_error(tmp_path: Path) -> None:
    files = SavedFiles()
    assert files.look([str(tmp_path / "nothing")]) == []


@pytest.mark.parametrize(
    ("changed", "expected"),
    [
        (["proj.sensors.ears"], {"proj.sensors.ears"}),
        (["proj.maths"], {"proj.maths", "proj.tools", "proj.sensors.ears"}),
        (["proj.tools"], {"proj.tools", "proj.sensors.ears"}),
        (["proj.builder"], set()),
    ],
)
def test_what_imports_a_module_is_imported_anew_with_it(tmp_path: Path, changed: list[str], expected: set[str]) -> None:
    texts = {
        "proj": "",
        "proj.maths": "",
        "proj.tools": "def late():\n    from . import maths\n",
        "proj.sensors": "",
        "proj.sensors.ears": "from ..tools import late\n",
        "proj.builder": "import proj.sensors.ears\n",
    }
    packages = {"proj", "proj.sensors"}
    sources = {}
    for name, text in texts.items():
        path = tmp_path / name.replace(".", "/") / "__init__.py" if name in packages else tmp_path / f"{name}.py"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
        sources[name] = str(path)
    assert to_renew(changed, ["proj.sensors.ears"], sources) == expected
