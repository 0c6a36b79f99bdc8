"""Recordings of strangers: they name no programs and call no services that write files."""

from __future__ import annotations

import contextlib
import json
from typing import TYPE_CHECKING, Any

import pytest

import morse
from morse.core.journal import SERVICE, Entry
from morse.launch.recorded_run import options_of
from morse.recording.errors import RecordingError
from morse.simulation.input_recording import InputRecording
from morse.simulation.recorders import SCRIPT
from morse.simulation.replaying import Replay

if TYPE_CHECKING:
    from pathlib import Path

PROGRAM = b"from morse.builder import *\nrobot = ATRV()\nenv = Environment('empty')\n"


class Foreign:
    """The part of a recording that names its scene."""

    path = "run.mcap"

    def __init__(self, script: str, kept: bytes | None = PROGRAM, **folders: list[str]) -> None:
        self.facts = {"script": script, **{name: json.dumps(paths) for name, paths in folders.items()}}
        self.attachments = {} if kept is None else {SCRIPT: kept}

    def attachment(self, name: str) -> bytes | None:
        return self.attachments.get(name)

    def texts(self, name: str) -> list[str]:
        return list(json.loads(self.facts.get(name, "[]")))

    def number(self, name: str) -> int:
        return 0


def opened(recording: Any, *, scene: str = "", trust: bool = False) -> Any:
    with contextlib.ExitStack() as stack:
        return options_of(recording, scene, trust, stack, lambda _: None)


@pytest.fixture
def project(tmp_path: Path) -> Path:
    (tmp_path / "mine" / "src").mkdir(parents=True)
    script = tmp_path / "mine" / "scene.py"
    script.write_bytes(PROGRAM)
    return script


def test_a_program_that_came_with_the_file_is_not_executed(project: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(project.parent)
    for script in ("scene.py", "./scene.py", "//server/share/scene.py", "\\\\server\\share\\scene.py"):
        with pytest.raises(RecordingError, match="not a full path"):
            opened(Foreign(script))
    # without the script in the recording, any program on the disk could be meant
    with pytest.raises(RecordingError, match="does not contain it"):
        opened(Foreign(str(project), kept=None))
    assert opened(Foreign(str(project))).script == str(project)


def test_modules_of_other_folders_are_not_imported(project: Path, tmp_path: Path) -> None:
    own = str(project.parent / "src")
    assert opened(Foreign(str(project), source_paths=[own])).source_paths == [own]
    (tmp_path / "other").mkdir()
    (project.parent / "link").symlink_to(tmp_path / "other")
    for folder in (str(tmp_path / "other" / "src"), "src", "//server/share", "/", str(project.parent / "link")):
        recording = Foreign(str(project), source_paths=[folder])
        with pytest.raises(RecordingError, match="does not belong to the project"):
            opened(recording)
        with pytest.raises(RecordingError, match="--trust"):
            opened(recording, scene=str(project))
        assert opened(recording, trust=True).source_paths == [folder]
    with pytest.raises(RecordingError, match="does not belong"):
        opened(Foreign(str(project), resource_paths=["//server/models"]))


def test_services_that_write_files_are_not_called(project: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(project.parent)
    calls = [("simulation", "save", ["mine", True]), ("simulation", "start_recording", ["mine"])]
    entries = [Entry(0, SERVICE, name, (service, given)) for name, service, given in calls]
    entries.append(Entry(0, SERVICE, "simulation", ("deactivate", ["robot"])))
    with morse.load(project) as sim:
        replay = Replay(sim, InputRecording(0, None, 1, entries))
        replay.run()
        assert not sim.context.robots["robot"].active, "services that change the simulation are called"
    assert sorted(path.name for path in project.parent.iterdir()) == ["scene.py", "src"]
