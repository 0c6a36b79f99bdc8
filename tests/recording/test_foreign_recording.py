"""Recordings of strangers: they name no programs and call no services that write files."""

import contextlib
import json
from pathlib import Path
from typing import Any

import pytest

import morse
from morse.core.journal import SERVICE, Entry
from morse.launch.recorded_run import options_of
from morse.recording.errors import RecordingError
from morse.simulation.recordings.input_recording import InputRecording
from morse.simulation.recordings.recorders import SCRIPT
from morse.simulation.recordings.replaying import Replay

PROGRAM = b"from morse.builder import *\nrobot = ATRV()\nenv = Environment('empty')\n"


class Foreign:
    """The part of a recording that names its scene."""

    def __init__(self, path: Path, script: str, kept: bytes | None = PROGRAM, **lists: list[str]) -> None:
        self.path = str(path)
        self.facts = {"script": script, **{name: json.dumps(words) for name, words in lists.items()}}
        self.attachments = {} if kept is None else {SCRIPT: kept}

    def attachment(self, name: str) -> bytes | None:
        return self.attachments.get(name)

    def texts(self, name: str) -> list[str]:
        return list(json.loads(self.facts.get(name, "[]")))

    def number(self, name: str) -> int:
        return 0


def opened(recording: Any, *projects: Path, scene: str = "", trust: bool = False) -> Any:
    said: list[str] = []
    with contextlib.ExitStack() as stack:
        options = options_of(recording, scene, trust, stack, said.append, [str(one) for one in projects])
    return options, "\n".join(said)


@pytest.fixture
def file(tmp_path: Path) -> Path:
    """A recording in a folder of its own."""
    (tmp_path / "received").mkdir()
    return tmp_path / "received" / "run.mcap"


@pytest.fixture
def project(tmp_path: Path) -> Path:
    """A project of the user, with a scene and other programs."""
    folder = tmp_path / "mine"
    for name in ("src", "data", "scripts"):
        (folder / name).mkdir(parents=True)
    (folder / "scene.py").write_bytes(PROGRAM)
    (folder / "scripts" / "scene.py").write_bytes(PROGRAM)
    (folder / "setup.py").write_bytes(b"import os\n")
    (folder / "link.py").symlink_to(folder / "scripts" / "scene.py")
    return folder


def test_a_scene_of_a_registered_project_is_executed_with_the_folders_of_the_project(file: Path, project: Path) -> None:
    lists = {"arguments": ["--harm"], "source_paths": ["/other/src"], "resource_paths": ["//server/models"]}
    options, said = opened(Foreign(file, str(project / "scene.py"), **lists), project)
    assert (options.script, options.arguments) == (str(project / "scene.py"), [])
    assert (options.source_paths, options.resource_paths) == ([str(project / "src")], [str(project / "data")])
    assert "does not get the arguments of the recorded run, ['--harm']" in said


def test_other_scripts_are_not_executed(file: Path, project: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(project)
    here = str(project)
    scripts = ["scene.py", "./scene.py", "//server/share/scene.py", "\\\\server\\scene.py", "/proc/self/cwd/scene.py"]
    scripts += ["/dev/fd/0", f"{here}/scripts/scene.py", f"{here}/link.py", f"{here}/scripts/../scene.py"]
    scripts += [f"{here}//scene.py", f"{here}/./scene.py", f"{here}/SCENE.py", f"{here}/gone.py", f"{here}/scene.py\0"]
    for script in scripts:
        with pytest.raises(RecordingError, match="--scene PATH"):
            opened(Foreign(file, script), project)
    # nor a scene of a project that is not registered, or one beside the recording
    for recording, projects in (
        (Foreign(file, f"{here}/scene.py"), [project.parent]),
        (Foreign(project / "run.mcap", f"{here}/scene.py"), [project]),
    ):
        with pytest.raises(RecordingError, match="folder of"):
            opened(recording, *projects)
    # nor a program that is not a scene, that has changed, or that cannot be compared
    for name, kept, why in (
        ("setup.py", b"import os\n", "does not import morse"),
        ("scene.py", b"#", "changed"),
        ("scene.py", None, "not contain"),
    ):
        with pytest.raises(RecordingError, match=why):
            opened(Foreign(file, f"{here}/{name}", kept), project)


def test_the_script_of_the_user_gets_no_arguments_and_folders_of_the_file(file: Path, project: Path) -> None:
    own = str(project / "scripts" / "scene.py")
    recording = Foreign(file, "/nowhere.py", arguments=["--harm"], source_paths=["/other/src"])
    options, said = opened(recording, project, scene=own)
    assert (options.script, options.arguments, options.source_paths) == (own, [], [str(project / "src")])
    assert "--trust passes them" in said


def test_what_is_trusted_is_shown(file: Path, project: Path) -> None:
    kept = PROGRAM + b"\n".join(b"# line %d \x1b[2J" % number for number in range(30))
    recording = Foreign(file, "/nowhere/scene.py", kept, arguments=["--fast"], source_paths=["/other/src"])
    options, said = opened(recording, trust=True)
    assert (options.arguments, options.source_paths) == (["--fast"], ["/other/src"])
    assert "executes the script inside the recording" in said
    assert "with the arguments ['--fast']" in said
    assert "| robot = ATRV()" in said
    assert "21 more lines" in said
    assert "/other/src" in said
    assert "\x1b" not in said
    same, said = opened(Foreign(file, str(project / "scene.py")), trust=True)
    assert same.script == str(project / "scene.py")
    assert f"executes {project / 'scene.py'} without arguments" in said


def test_services_that_write_files_are_not_called(project: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(project)
    calls = [("simulation", "save", ["mine", True]), ("simulation", "start_recording", ["mine"])]
    entries = [Entry(0, SERVICE, name, (service, given)) for name, service, given in calls]
    entries.append(Entry(0, SERVICE, "simulation", ("deactivate", ["robot"])))
    before = sorted(path.name for path in project.iterdir())
    with morse.load(project / "scene.py") as sim:
        replay = Replay(sim, InputRecording(0, None, 1, entries))
        replay.run()
        assert not sim.context.robots["robot"].active, "services that change the simulation are called"
    assert sorted(path.name for path in project.iterdir()) == before
