"""Components of a user's own project: the file of the component is enough."""

import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from morse.builder.errors import ScriptError
from morse.scene import Scene

SONAR = """
from morse.core.declarations import BuilderDefaults
from morse.core.sensor import Sensor
from morse.helpers.components import add_data

class Sonar(Sensor):
    _name = "Sonar"
    _short_desc = "Measures a distance by sound"
    _builder = BuilderDefaults(frequency=12.0)
    _products = (BuilderDefaults("FastSonar", frequency=48.0),)

    add_data("distance", 0.0, "float", "Distance", unit="m")
"""
EYES = "from morse.core.actuator import Actuator\nclass Eyes(Actuator):\n    pass\n"
ROVER = """
from morse.core.classes.builder_defaults import RobotDefaults
from morse.core.robot import Robot

class Rover(Robot):
    _name = "Rover"
    _builder = RobotDefaults("atrv", properties={"Team": "red"})
"""
OLD_PAIR = """
from morse.builder.creator import SensorCreator

class Bat(SensorCreator):
    _classpath = "lab.sensors.sonar.Sonar"

    def __init__(self, name=None):
        SensorCreator.__init__(self, name)
        self.frequency(3.0)
"""
HEAD = "from morse.builder import *\n"
END = "env = Environment('empty', fastmode=True)\n"


@pytest.fixture
def lab(tmp_path: Path) -> Path:
    """The package of a project that only contains files of components."""
    package = tmp_path / "src" / "lab"
    for kind, name, text in (("sensors", "sonar", SONAR), ("actuators", "eyes", EYES), ("robots", "rover", ROVER)):
        (package / kind).mkdir(parents=True)
        (package / kind / f"{name}.py").write_text(text)
    return package


@pytest.fixture
def scene(lab: Path, load: Callable[..., Scene]) -> Callable[..., Scene]:
    """Runs a text as the scene script of the project."""
    return lambda text: load(HEAD + text + END, source="src")


def declared(scene: Scene) -> dict[str, tuple[str, float | None]]:
    return {c.node.name: (c.classpath, c.frequency) for c in scene.components}


def test_the_file_of_a_component_is_enough(scene: Callable[..., Scene]) -> None:
    text = (
        "from lab.builder.sensors import Sonar, FastSonar\n"
        "from lab.builder.actuators import Eyes\n"
        "from lab.builder.robots import Rover\n"
        "robot, sonar, fast, eyes = Rover(), Sonar(), FastSonar(), Eyes('look')\n"
        "for part in (sonar, fast, eyes): robot.append(part)\n"
        "robot.add_default_interface('socket')\n"
    )
    made = scene(text)
    assert declared(made) == {
        "robot": ("lab.robots.rover.Rover", None),
        "robot.sonar": ("lab.sensors.sonar.Sonar", 12.0),
        "robot.fast": ("lab.sensors.sonar.Sonar", 48.0),
        "robot.look": ("lab.actuators.eyes.Eyes", 60.0),
    }
    robot = next(c for c in made.components if c.kind == "robot").node
    assert robot.body.moves
    assert robot.properties["GroundRobot"] is True
    assert robot.properties["Team"] == "red"


def test_a_module_of_derived_classes_can_be_imported_whole(scene: Callable[..., Scene]) -> None:
    text = "from lab.builder.sensors import *\nfrom lab.builder import sensors\n"
    text += "assert sensors.Sonar is Sonar and sensors.__all__ == ['FastSonar', 'Sonar']\n"
    text += "robot, sonar = FakeRobot(), Sonar()\nrobot.append(sonar)\n"
    assert declared(scene(text))["robot.sonar"][0] == "lab.sensors.sonar.Sonar"


def test_the_class_that_runs_makes_its_builder_in_a_scene_script(scene: Callable[..., Scene]) -> None:
    text = "from lab.sensors.sonar import Sonar\nrobot, sonar = FakeRobot(), Sonar()\n"
    text += "sonar.translate(z=1.0)\nrobot.append(sonar)\nrobot.append(Sonar('second'))\n"
    assert declared(scene(text)) == {
        "robot": ("morse.robots.fakerobot.FakeRobot", None),
        "robot.sonar": ("lab.sensors.sonar.Sonar", 12.0),
        "robot.second": ("lab.sensors.sonar.Sonar", 12.0),
    }


def test_pairs_of_files_go_on_working_beside_single_files(lab: Path, scene: Callable[..., Scene]) -> None:
    builders = lab / "builder" / "sensors"
    builders.mkdir(parents=True)
    for folder in (lab, lab / "builder", builders):
        (folder / "__init__.py").write_text("")
    (builders / "__init__.py").write_text("from .bat import Bat\n")
    (builders / "bat.py").write_text(OLD_PAIR)
    text = "from lab.builder.sensors import Bat, Sonar\nfrom lab.builder.sensors.bat import Bat as Same\n"
    text += "assert Bat is Same\nrobot, bat, sonar = FakeRobot(), Bat(), Sonar()\n"
    text += "robot.append(bat)\nrobot.append(sonar)\n"
    found = declared(scene(text))
    assert found["robot.bat"] == ("lab.sensors.sonar.Sonar", 3.0)
    assert found["robot.sonar"] == ("lab.sensors.sonar.Sonar", 12.0)


def test_a_folder_of_builders_without_an_init_file(lab: Path, scene: Callable[..., Scene]) -> None:
    builders = lab / "builder" / "sensors"
    builders.mkdir(parents=True)
    (builders / "bat.py").write_text(OLD_PAIR)
    text = "from lab.builder.sensors.bat import Bat\nfrom lab.builder.sensors import Sonar\n"
    text += "robot, bat, sonar = FakeRobot(), Bat(), Sonar()\nrobot.append(bat)\nrobot.append(sonar)\n"
    assert set(declared(scene(text))) == {"robot", "robot.bat", "robot.sonar"}


def test_a_component_that_inherits_a_scanner_keeps_its_methods(lab: Path, scene: Callable[..., Scene]) -> None:
    (lab / "sensors" / "lidar.py").write_text(
        "from morse.sensors.laserscanner import LaserScanner\nclass Lidar(LaserScanner):\n    pass\n"
    )
    text = "from lab.builder.sensors import Lidar\nrobot, lidar = FakeRobot(), Lidar()\nrobot.append(lidar)\n"
    assert "robot.lidar" in declared(scene(text + "lidar.create_laser_arc()\n"))


@pytest.mark.parametrize(
    ("text", "line", "answers"),
    [
        ("from lab.builder.sensors import Sonnar\n", 2, ["'Sonnar'", "lab.builder.sensors", "Did you mean 'Sonar'?"]),
        ("from lab.builder.sensor import Sonar\n", 2, ["lab.builder.sensor", "Did you mean 'lab.builder.sensors'?"]),
        ("from lab.builder.sensors import Range\n", 2, ["lab.sensors.odd.Range is not a component", "Sensor"]),
        ("from lab.sensors.odd import Range\nrobot = FakeRobot()\nrobot.append(Range())\n", 4, ["takes a component"]),
    ],
)
def test_mistakes(lab: Path, scene: Callable[..., Scene], text: str, line: int, answers: list[str]) -> None:
    (lab / "sensors" / "odd.py").write_text("class Base: pass\nclass Range(Base): pass\n")
    with pytest.raises(ScriptError) as caught:
        scene(text)
    assert caught.value.where is not None
    assert caught.value.where.line == line
    for answer in answers:
        assert answer in caught.value.report()


def test_a_broken_file_hinders_only_those_who_want_it(lab: Path, scene: Callable[..., Scene]) -> None:
    (lab / "sensors" / "radar.py").write_text("class Radar(:\n")
    text = "from lab.builder.sensors import Sonar\nrobot, sonar = FakeRobot(), Sonar()\nrobot.append(sonar)\n"
    assert "robot.sonar" in declared(scene(text))
    with pytest.raises(ScriptError, match=r"SyntaxError") as caught:
        scene("from lab.builder.sensors import Radar\n")
    assert str(caught.value.where).endswith("radar.py:1")


def test_nothing_of_it_reaches_packages_that_are_no_projects() -> None:
    with pytest.raises(ModuleNotFoundError):
        __import__("json.builder")
    with pytest.raises(ModuleNotFoundError):
        __import__("no_such_project.builder.sensors")
    assert len([finder for finder in sys.meta_path if type(finder).__name__ == "ProjectFinder"]) == 1
