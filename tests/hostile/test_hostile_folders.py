"""A model is data, wherever it lies: nothing in its folder is executed."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

import morse
from morse.assets.nearby_files import FileRefusedError, find_near
from morse.builder import bpymorse  # noqa: F401  # the builder is loaded before the folder can hide a module
from morse.builder.names.project_files import source_folders
from morse.core.exceptions import MorseError
from morse.recording.mcap.writer import McapWriter
from morse.system.free_names import free_path
from morse.system.regular_files import RefusedFileError, check_default_name
from morse.system.workers import command
from tests.kit.programs import commands

ROBOT = """<robot name="r"><link name="a"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0"
iyz="0"/></inertial><collision><geometry><box size="1 1 1"/></geometry></collision></link></robot>"""
PROJECT = """[project]
name = "evil"
version = "1"
[project.entry-points."morse.middleware"]
evil = "evil:Evil"
[project.entry-points."morse.components"]
evil = "evil"
"""


@pytest.fixture
def downloads(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with a model, and with a module for each one of Python and for each package that MORSE needs."""
    folder = tmp_path / "downloads"
    (folder / "src/evil/builder/robots").mkdir(parents=True)
    (folder / "pyproject.toml").write_text(PROJECT)
    modules = [f"{name}.py" for name in sys.stdlib_module_names if not name.startswith("_")]
    modules += ["numpy.py", "mujoco.py", "msgspec.py", "rich.py", "typer.py", "morse.py", "evil.py", "default.py"]
    modules += ["src/evil/__init__.py", "src/evil/builder/__init__.py", "src/evil/builder/robots/__init__.py"]
    for name in modules:
        (folder / name).write_text(f"open({str(folder / 'mark')!r}, 'w').close()\n")
    (folder / "robot.urdf").write_text(ROBOT)
    monkeypatch.chdir(folder)
    return folder


@pytest.mark.parametrize("words", [["check"], ["run", "--duration", "0.05"]])
def test_commands_run_nothing_beside_a_model(downloads: Path, words: list[str]) -> None:
    main = "from morse.cli import main; main()"
    program = [sys.executable, "-P", "-c", main, *words, "robot.urdf"]
    subprocess.run(program, cwd=downloads, capture_output=True, check=True, timeout=60)
    assert not (downloads / "mark").exists()


def test_a_program_of_morse_runs_nothing_in_the_present_folder(downloads: Path) -> None:
    subprocess.run(command("morse.version"), cwd=downloads, capture_output=True, check=True, timeout=60)
    assert not (downloads / "mark").exists()


def test_a_simulation_of_a_model_offers_no_classes_beside_it(downloads: Path) -> None:
    assert source_folders(downloads / "robot.urdf") == []
    with morse.load("robot.urdf") as simulation:
        with pytest.raises(MorseError, match="no model 'evil"):
            simulation.spawn("evil", "evil.builder.robots:Evil")
        assert simulation.options.source_paths == []
    assert not (downloads / "mark").exists()


@pytest.mark.parametrize("name", ["package://{home}/photo.png", "package://private/photo.png", "../../photo.png"])
def test_a_package_is_not_the_home_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str) -> None:
    monkeypatch.setenv("HOME", str(tmp_path))
    for folder in (tmp_path, tmp_path / "private", tmp_path / "downloads/arm"):
        folder.mkdir(parents=True, exist_ok=True)
        (folder / f"{'own' if folder.name == 'arm' else 'photo'}.png").write_bytes(b"")
    model = tmp_path / "downloads/arm/arm.urdf"
    with pytest.raises(FileRefusedError):
        find_near(name.format(home=tmp_path.name), model)
    assert find_near("package://downloads/arm/own.png", model).is_file()
    (tmp_path / "private/package.xml").write_text("<package/>")
    assert find_near("package://private/photo.png", model).is_file()


def test_a_description_of_a_stranger_reads_no_temporary_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    (tmp_path / "of_others").mkdir()
    (tmp_path / "of_others/photo.png").write_bytes(b"")
    model = tmp_path / "morse-description-1/model/description.urdf"
    model.parent.mkdir(parents=True)
    for name in ("package://of_others/photo.png", f"package://{tmp_path.name}/of_others/photo.png"):
        with pytest.raises(FileRefusedError):
            find_near(name, model)


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="needs links and pipes")
@pytest.mark.parametrize("kind", ["link", "dangling link", "hard link", "pipe", "folder"])
def test_a_name_that_the_user_has_not_chosen_leads_nowhere(tmp_path: Path, kind: str) -> None:
    precious, path = tmp_path / "precious", tmp_path / "downloads/robot_check.png"
    path.parent.mkdir()
    check_default_name(path)
    path.write_bytes(b"an earlier picture")
    check_default_name(path)
    path.unlink()
    if kind != "dangling link":
        precious.write_text("mine")
    if kind == "hard link":
        path.hardlink_to(precious)
    elif kind == "pipe":
        os.mkfifo(path)
    elif kind == "folder":
        path.mkdir()
    else:
        path.symlink_to(precious)
    with pytest.raises(RefusedFileError, match="is not written: give another name"):
        check_default_name(path)
    assert free_path(path) == path.with_stem("robot_check_2")


def test_no_command_writes_through_a_link_that_came_with_a_folder(tmp_path: Path) -> None:
    world = '<sdf version="1.7"><world name="$(touch evil)"><model name="m"><link name="l"/></model></world></sdf>'
    links = {
        "check robot.urdf": "robot_check.png",
        "render robot.urdf": "picture.png",
        "import-world -f world.sdf": "scene.py",
        "import-world world.sdf": "scene.py",
        "export --foxglove-layout run.mcap": "run-layout.json",
        "export --film run.mcap": "run.gif",
        "export --mcap run.mcap": "run-complete.mcap",
        "export --csv run.mcap": "run",
    }
    lines = []
    for exists in (True, False):
        for words, name in links.items():
            downloads = tmp_path / str(len(lines)) / "downloads"
            downloads.mkdir(parents=True)
            (downloads / "robot.urdf").write_text(ROBOT)
            (downloads / "world.sdf").write_text(world)
            with open(downloads / "run.mcap", "wb", buffering=0) as file:
                McapWriter(file).finish()
            precious = downloads.parent / "precious"
            (downloads / name).symlink_to(precious)
            if exists:
                precious.write_text("mine")
            lines.append((downloads, words.split()))
    for (downloads, words_of_line), outcome in zip(lines, commands(lines), strict=True):
        precious = downloads.parent / "precious"
        exists = int(downloads.parent.name) < len(links)
        assert precious.read_text() == "mine" if exists else not precious.exists(), words_of_line
        assert outcome.status != 0, words_of_line
        assert "Traceback" not in outcome.err, words_of_line


def test_no_command_writes_the_file_that_it_reads(tmp_path: Path) -> None:
    with open(tmp_path / "run.mcap", "wb", buffering=0) as file:
        McapWriter(file).finish()
    (tmp_path / "link.mcap").symlink_to("run.mcap")
    (tmp_path / "world.sdf").write_text('<sdf version="1.7"><world name="w"/></sdf>')
    before = [(tmp_path / name).read_bytes() for name in ("run.mcap", "world.sdf")]
    lines = [
        "export --html run.mcap run.mcap",
        "export --foxglove-layout -o ./run.mcap run.mcap",
        "export --mcap -o link.mcap run.mcap",
        "import-world -f -o world.sdf world.sdf",
    ]
    for line, outcome in zip(lines, commands((tmp_path, line.split()) for line in lines), strict=True):
        assert outcome.status == 2, line
        assert "is the file that is read" in " ".join(outcome.err.split()), line
    assert [(tmp_path / name).read_bytes() for name in ("run.mcap", "world.sdf")] == before
