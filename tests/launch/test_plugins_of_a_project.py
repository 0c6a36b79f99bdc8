"""A project declares its plugins in its ``pyproject.toml``, and its models are in ``data``, without an installation."""

import importlib.util
import logging
import sys
from pathlib import Path

import pytest

import morse
from morse import builder
from morse.builder.errors import ScriptError
from morse.core.classes.plugins import entry_points

HALVED = """
from morse.core.modifier import AbstractModifier

class Halved(AbstractModifier):
    _names = ("Halved",)
    _components = ("Pose",)

    def modify(self):
        self.data["x"] *= {factor}
"""
SILENT = """
from morse.core.datastream import DatastreamManager
from morse.core.declarations import Option
from morse.core.mapping import maps

class Silent(DatastreamManager):
    manager_options = {"volume": Option(int, 0, "how loud", low=0)}
    sent = []

    @maps("general")
    def general(self, stream, message):
        return dict(message.fields)

    def send(self, stream, payload):
        self.sent.append(payload)
"""
MAPPING = """
from morse.middleware.registry import Middleware

MIDDLEWARE = Middleware("silent", stream_manager="lab.silent.Silent", manager_options=None)
"""
PROJECT = """
[project.entry-points."morse.modifiers"]
lab = "lab.changes"

[project.entry-points."morse.middlewares"]
silent = "lab.mapping:MIDDLEWARE"
"""
SCENE = """
from morse.builder import *
robot = FakeRobot()
robot.translate(x=4.0)
pose = Pose()
pose.alter("Halved")
pose.add_stream("silent")
robot.append(pose)
env = Environment("empty")
"""
BOX = """<robot name="box"><link name="base"><inertial><mass value="2.0"/>
<inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial>
<collision><geometry><box size="1 1 1"/></geometry></collision></link></robot>"""
FUNCTION = """
def scene():
    from morse.builder import Environment, Robot
    robot = Robot("lab/robots/box.urdf")
    robot.translate(z=0.5)
    Environment("empty")
"""


def project(folder: Path, factor: float = 0.5, declared: str = PROJECT) -> Path:
    """The script of a project in a new folder."""
    files = {
        "pyproject.toml": declared,
        "scene.py": SCENE,
        "src/lab/__init__.py": "",
        "src/lab/changes/halved.py": HALVED.format(factor=factor),
        "src/lab/silent.py": SILENT,
        "src/lab/mapping.py": MAPPING,
        "data/lab/robots/box.urdf": BOX,
        "tests/scenes.py": FUNCTION,
    }
    for path, text in files.items():
        (folder / path).parent.mkdir(parents=True, exist_ok=True)
        (folder / path).write_text(text)
    return folder / "scene.py"


@pytest.mark.parametrize("sockets", [False, True])
def test_modifiers_and_middlewares_of_a_project_have_names(tmp_path: Path, sockets: bool) -> None:
    with morse.load(project(tmp_path), sockets=sockets) as simulation:
        simulation.step(2)
        assert simulation.robot.pose.data["x"] == pytest.approx(2.0)
        managers = [one for one in simulation.context.stream_managers.values() if type(one).__name__ == "Silent"]
        assert bool(managers) is sockets
        assert not managers or managers[0].sent[-1]["x"] == pytest.approx(2.0)


PLACES = {
    "a module": ("lab.changes", "changes.py"),
    "a class": ("lab.changes:Halved", "changes.py"),
    "a class in a package": ("lab.changes:Halved", "changes/halved.py"),
    "the file of a package": ("lab.changes", "changes/__init__.py"),
    "the package itself": ("lab", "__init__.py"),
}


@pytest.mark.parametrize("where", PLACES)
def test_an_entry_point_names_a_package_a_module_or_a_class(
    where: str, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    place, file = PLACES[where]
    script = project(tmp_path, declared=PROJECT.replace('"lab.changes"', f'"{place}"'))
    (tmp_path / "src/lab/changes/halved.py").unlink()
    (tmp_path / "src/lab/changes").rmdir()
    (tmp_path / "src/lab" / file).parent.mkdir(exist_ok=True)
    (tmp_path / "src/lab" / file).write_text(HALVED.format(factor=0.25))
    with caplog.at_level(logging.WARNING), morse.load(script) as simulation:
        simulation.step(2)
        assert simulation.robot.pose.data["x"] == pytest.approx(1.0)
    assert "left out" not in caplog.text


@pytest.mark.parametrize(
    ("place", "old", "new", "words"),
    [
        ("lab.chances", "", "", "no package or module 'lab.chances'"),
        ("lab.changes:Quartered", "", "", "it has no class Quartered with _names"),
        ("lab.changes", '_names = ("Halved",)', "", "it has no class with _names"),
        ("lab.changes", '("Halved",)', '"Halved"', "_names of Halved is 'Halved', expected a tuple of names"),
        ("lab.changes", '("Pose",)', '"Pose"', "_components of Halved is 'Pose', expected a tuple of names"),
    ],
)
def test_an_entry_point_without_a_modifier_is_named(
    place: str, old: str, new: str, words: str, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    script = project(tmp_path, declared=PROJECT.replace('"lab.changes"', f'"{place}"'))
    (tmp_path / "src/lab/changes/halved.py").write_text(HALVED.format(factor=0.5).replace(old, new))
    with caplog.at_level(logging.WARNING), pytest.raises(ScriptError, match="no modifier 'Halved'"):
        morse.load(script)
    assert words in caplog.text
    assert f"the modifiers of {place} are left out" in caplog.text


def test_a_modifier_for_another_component_says_for_which(tmp_path: Path) -> None:
    script = project(tmp_path)
    (tmp_path / "src/lab/changes/halved.py").write_text(HALVED.format(factor=0.5).replace('"Pose"', '"Poze"'))
    with pytest.raises(ScriptError, match="the modifier 'Halved' is for Poze, not for Pose"):
        morse.load(script)


GLOW = """
from morse.core.sensor import Sensor
from morse.helpers.components import add_data

class {name}(Sensor):
    _name = "{name}"
    add_data("level", {level}, "float", "Level")
"""
GLOWING = """
{line}
robot = FakeRobot()
glow = {name}("glow")
robot.append(glow)
env = Environment("empty")
"""


def glowing(folder: Path, name: str, level: float, line: str, file: str) -> Path:
    """The script of a project with a sensor, which the line imports."""
    files = {
        "pyproject.toml": '[project.entry-points."morse.components"]\nlab = "lab"\n',
        "src/lab/__init__.py": "",
        f"src/lab/{file}": GLOW.format(name=name, level=level),
        "scene.py": GLOWING.format(name=name, line=line),
    }
    for path, text in files.items():
        (folder / path).parent.mkdir(parents=True, exist_ok=True)
        (folder / path).write_text(text)
    return folder / "scene.py"


@pytest.mark.parametrize("file", ["sensors/glow.py", "sensors/__init__.py", "sensors.py"])
@pytest.mark.parametrize(
    "line", ["from morse.builder import *", "from morse.builder import Environment, FakeRobot, Glow"]
)
def test_components_of_a_project_come_with_the_others(tmp_path: Path, line: str, file: str) -> None:
    before = dict(vars(builder))
    with morse.load(glowing(tmp_path, "Glow", 3.0, line, file)) as simulation:
        simulation.step()
        assert simulation.robot.glow.data["level"] == 3.0
    assert dict(vars(builder)) == before


def test_projects_with_packages_of_one_name_have_their_own_components(tmp_path: Path) -> None:
    line = "from morse.builder import *"
    for folder, name, level in (("a", "Glow", 1.0), ("b", "Glow", 2.0), ("c", "Gleam", 3.0)):
        with morse.load(glowing(tmp_path / folder, name, level, line, "sensors/light.py")) as simulation:
            simulation.step()
            assert simulation.robot.glow.data["level"] == level
    (tmp_path / "c/scene.py").write_text(GLOWING.format(name="Glow", line=line))
    with pytest.raises(ScriptError, match="the name 'Glow' is not defined"):
        morse.load(tmp_path / "c/scene.py")


def test_no_component_of_a_project_hides_one_of_morse(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    script = glowing(tmp_path, "Pose", 1.0, "from morse.builder import *", "sensors/light.py")
    with caplog.at_level(logging.WARNING), morse.load(script) as simulation:
        simulation.step()
        assert "x" in simulation.robot.glow.data
    assert "Pose of the project is left out" in caplog.text


def test_projects_with_packages_of_one_name_do_not_meet(tmp_path: Path) -> None:
    for folder, factor in (("a", 0.5), ("b", 0.25)):
        with morse.load(project(tmp_path / folder, factor)) as simulation:
            simulation.step(2)
            assert simulation.robot.pose.data["x"] == pytest.approx(4.0 * factor)


@pytest.mark.parametrize("text", [PROJECT + "[", "[project.entry-points]\n'morse.modifiers' = 3\n"])
def test_a_damaged_pyproject_is_named(tmp_path: Path, text: str, caplog: pytest.LogCaptureFixture) -> None:
    script = project(tmp_path, declared=text)
    with caplog.at_level(logging.WARNING), pytest.raises(ScriptError, match="no modifier 'Halved'"):
        morse.load(script)
    assert "pyproject.toml" in caplog.text


def test_a_middleware_that_is_not_declared_is_named_with_the_mend(tmp_path: Path) -> None:
    script = project(tmp_path, declared="")
    script.write_text(SCENE.replace('pose.alter("Halved")', ""))
    with pytest.raises(ScriptError, match=r"'morse\.middlewares' in pyproject\.toml"):
        morse.load(script, sockets=True)


@pytest.mark.parametrize("sockets", [False, True])
def test_a_wrong_option_of_a_manager_is_refused_at_its_line(tmp_path: Path, sockets: bool) -> None:
    script = project(tmp_path)
    script.write_text(SCENE + 'env.configure_stream_manager("silent", volme=3)\n')
    with pytest.raises(ScriptError, match=r"scene\.py:10: .* no option 'volme'; did you mean 'volume'"):
        morse.load(script, sockets=sockets)


def test_a_function_of_a_project_finds_its_models(tmp_path: Path) -> None:
    project(tmp_path)
    spec = importlib.util.spec_from_file_location("scenes_of_lab", tmp_path / "tests" / "scenes.py")
    assert spec is not None
    assert spec.loader is not None
    scenes = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(scenes)
    with morse.load(scenes.scene) as simulation:
        simulation.step()
        assert simulation.context.component("robot").bge_object.mass == pytest.approx(2.0)


def test_a_component_class_in_the_script_is_named_with_the_mend(tmp_path: Path) -> None:
    script = tmp_path / "scene.py"
    script.write_text(
        "from morse.builder import *\nfrom morse.core.sensor import Sensor\n\n\nclass Altitude(Sensor):\n"
        "    _name = 'Altitude'\n\n\nrobot = FakeRobot()\naltitude = Altitude()\nrobot.append(altitude)\n"
        "env = Environment('empty')\n"
    )
    with pytest.raises(ScriptError, match=r"altitude\.py beside the script, and write `from altitude import Altitude`"):
        morse.load(script)


def test_what_was_installed_of_a_project_gives_way_to_its_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """An installation for development keeps the entry points of the day on which it was made."""
    declared = '[project]\nname = "My.Lab"\n' + PROJECT.replace("lab.changes", "lab.other")
    source = project(tmp_path / "lab", declared=declared).parent / "src"
    installed = tmp_path / "packages"
    for name, module in (("my_lab", "lab.changes"), ("others", "others.changes")):
        folder = installed / f"{name}-1.0.dist-info"
        folder.mkdir(parents=True)
        (folder / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: 1.0\n")
        (folder / "entry_points.txt").write_text(f"[morse.modifiers]\n{name} = {module}\n")
    monkeypatch.setattr(sys, "path", [str(source), str(installed)])
    assert [point.value for point in entry_points("morse.modifiers")] == ["lab.other", "others.changes"]
