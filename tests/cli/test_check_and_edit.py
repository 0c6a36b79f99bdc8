"""check: the installed programs; edit: the right file in the right program."""

import importlib.metadata
import stat
import sys
from pathlib import Path

import pytest

from morse.assets.search import MORSE_COMPONENTS
from morse.cli import check as findings_module
from morse.cli.check import Finding, findings
from morse.kernel import loading, targets


@pytest.fixture
def blender(morse, monkeypatch):
    """A program in place of Blender: it records its arguments, and ends with status 3."""
    program = morse.home / "blender"
    log = morse.home / "blender.log"
    program.write_text(
        f"#!{sys.executable}\nimport sys\n"
        "if '--version' in sys.argv: print('Blender 3.4.1'); sys.exit()\n"
        f"open({str(log)!r}, 'w').write('\\n'.join(sys.argv[1:])); sys.exit(3)\n"
    )
    program.chmod(program.stat().st_mode | stat.S_IXUSR)
    monkeypatch.setenv("MORSE_BLENDER", str(program))
    return log


@pytest.fixture
def scene(morse):
    def write(text, name="scene.py"):
        path = morse.directory / name
        path.write_text(text)
        return path

    return write


def test_check_finds_what_the_tests_run_with(morse):
    answer = morse("check")
    assert answer.status == 0, answer.err
    assert "All requirements of MORSE are met." in answer.out
    for name in ("Python", "mujoco", "native kernel", "Blender"):
        assert name in answer.out


def test_check_announces_nothing_that_is_not_there(morse):
    text = morse("check").out
    for absent in ("OpenGL", "YARP", "nothing:"):
        assert absent not in text
    (line,) = [line for line in text.splitlines() if "Available middlewares: " in line]
    assert {"foxglove", "ros", "ros2", "socket"} <= set(line.partition(": ")[2].rstrip(".").split(", "))


def test_check_prints_the_data_directory_in_one_line(morse):
    assert f"* MORSE data directory: {MORSE_COMPONENTS}\n" in morse("check").out


def test_check_lists_more_data_directories(morse, monkeypatch):
    monkeypatch.setenv("MORSE_ROOT", str(morse.home))
    monkeypatch.setenv("MORSE_RESOURCE_PATH", str(morse.home / "nowhere"))
    (morse.home / "share" / "morse" / "data").mkdir(parents=True)
    lines = morse("check").out.splitlines()
    assert f"* Searched as well (MORSE_ROOT): {morse.home / 'share' / 'morse' / 'data'}" in lines
    assert f"* Searched as well (MORSE_RESOURCE_PATH): {morse.home / 'nowhere'}, which does not exist" in lines


def test_check_fails_if_something_required_is_missing(morse, monkeypatch):
    monkeypatch.setattr(findings_module, "_REQUIRED_MODULES", {"no_such_module": ("no-such-module", "nothing")})
    answer = morse("check")
    assert answer.status == 1
    assert "pip install no-such-module" in answer.out


@pytest.mark.parametrize(
    ("whole", "is_met"), [("3.17.0", False), ("2.3.7", False), ("4.0.0", True), ("4.0.1", True), (None, True)]
)
def test_check_names_two_mujocos_in_one_folder(morse, monkeypatch, whole, is_met):
    def version(name, ask=importlib.metadata.version):
        if name != "mujoco":
            return {"mujoco-core": "4.0.1"}.get(name) or ask(name)
        if whole is None:
            raise importlib.metadata.PackageNotFoundError(name)
        return whole

    monkeypatch.setattr(importlib.metadata, "version", version)
    answer = morse("check")
    assert (answer.status == 0) == is_met, answer.out
    assert ("pip uninstall -y mujoco mujoco-core" in answer.out) != is_met
    assert (f"mujoco {whole} and mujoco-core 4.0.1" in " ".join(answer.out.split())) != is_met


def test_check_says_what_the_rest_would_give(morse, monkeypatch):
    monkeypatch.setenv("MORSE_BLENDER", "/nowhere/blender")
    answer = morse("check")
    assert answer.status == 0
    assert "Optional: Blender" in answer.out
    assert "apt-get install blender" in answer.out


def test_a_broken_module_is_reported_not_raised(monkeypatch, tmp_path):
    (tmp_path / "zstandard.py").write_text("raise OSError('cannot open shared object')")
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.delitem(sys.modules, "zstandard", raising=False)
    finding = next(f for f in findings() if f.name == "zstandard")
    assert not finding.found
    assert "cannot open shared object" in finding.detail


def test_a_broken_kernel_is_reported_not_raised(monkeypatch, tmp_path):
    monkeypatch.delenv(loading.VARIABLE, raising=False)
    monkeypatch.setattr(targets, "FOLDER", tmp_path)
    for target in targets.ALL:
        for level in target.levels:
            (tmp_path / target.file_name(level)).write_bytes(b"no library")
    loading.library.cache_clear()
    finding = next(f for f in findings() if f.name == "native kernel")
    loading.library.cache_clear()
    assert not finding.found
    assert finding.required


def test_an_environment_that_does_not_see_ros_of_the_system_is_told_so(tmp_path, monkeypatch):
    (tmp_path / "rosgraph").mkdir()
    monkeypatch.setattr(findings_module, "_DEBIAN", str(tmp_path))
    monkeypatch.setattr(findings_module.importlib.util, "find_spec", lambda name: None)
    finding = next(one for one in findings_module._middlewares() if one.name == "rosgraph")
    assert not finding.found
    assert "--system-site-packages" in finding.install
    assert str(tmp_path) in finding.install


def test_a_blender_that_does_not_run_is_not_found(morse, monkeypatch):
    program = morse.home / "blender"
    program.write_text("#!/nowhere/interpreter\n")
    program.chmod(0o755)
    monkeypatch.setenv("MORSE_BLENDER", str(program))
    finding = next(f for f in findings() if f.name == "Blender")
    assert not finding.found


def test_everything_missing_says_how_to_get_it():
    for finding in findings():
        assert isinstance(finding, Finding)
        assert finding.gives
        assert finding.install or not finding.required


def test_edit_opens_the_world_of_the_scene(morse, scene, blender):
    world = morse.directory / "house.blend"
    world.write_bytes(b"")
    scene("from morse.builder import *\nenv = Environment('house.blend', fastmode=True)\n")
    assert morse("edit", "scene.py").status == 3
    assert blender.read_text() == str(world)


def test_edit_opens_a_world_of_morse_and_says_so(morse, blender):
    morse("create", "sim")
    answer = morse("edit", "sim")
    assert answer.status == 3
    assert blender.read_text() == str(Path(MORSE_COMPONENTS, "environments", "sandbox.blend"))
    assert "belongs to MORSE" in answer.out


def test_edit_opens_a_world_of_the_project(morse, blender):
    morse("create", "sim")
    data = morse.directory / "sim" / "data"
    data.mkdir()
    (data / "house.blend").write_bytes(b"")
    (morse.directory / "sim" / "default.py").write_text("env = Environment(filename='house')")
    answer = morse("edit", "sim")
    assert answer.status == 3
    assert blender.read_text() == str(data / "house.blend")
    assert f"A model of this project: {data / 'house.blend'}" in answer.out


def test_edit_of_a_blend_file(morse, scene, blender):
    path = scene("", "world.blend")
    assert morse("edit", "world.blend").status == 3
    assert blender.read_text() == str(path)


def test_edit_with_a_base_and_a_geometry(morse, scene, blender):
    scene("env = Environment(name)")
    base = scene("", "base.blend")
    assert morse("edit", "-b", "base.blend", "-g", "800x600+10,20", "scene.py").status == 3
    assert blender.read_text().splitlines() == ["--window-geometry", "10", "20", "800", "600", str(base)]


def test_edit_with_an_unknown_base(morse, scene, blender):
    scene("")
    answer = morse("edit", "-b", "nosuch.blend", "scene.py")
    assert answer.status == 1
    assert "nosuch.blend" in answer.err
    assert not blender.exists()


def test_edit_without_blender_says_what_to_do(morse, monkeypatch):
    monkeypatch.setenv("PATH", "")
    morse("create", "sim")
    answer = morse("edit", "sim")
    assert answer.status == 1
    assert "sandbox.blend" in answer.err
    assert "apt-get install blender" in answer.err
    assert "MORSE_BLENDER" in answer.err


@pytest.mark.parametrize(
    "text", ["env = Environment(name)", "", "env = Environment('nosuch')", "this is not Python", "x = '\0'", "(" * 5000]
)
def test_edit_of_a_scene_whose_world_is_not_to_be_found(morse, scene, blender, text):
    scene(text)
    answer = morse("edit", "scene.py")
    assert answer.status == 1
    assert answer.err.startswith("* ")
    assert answer.err.count("\n") == 1
    assert not blender.exists()


def test_edit_of_an_unknown_environment(morse, blender):
    assert morse("edit", "nosuch").status == 1
