"""Services of the simulation and checks of scenes by entry points: those that are broken are named and left out."""

import logging
from pathlib import Path

import pytest

import morse
from morse.launch.load import SceneWarningError

LAB = '''
import itertools

from morse.core.abstractobject import AbstractObject
from morse.core.services import service
from morse.scene import SceneWarning


class Counter(AbstractObject):
    """Counts ticks."""

    def __init__(self, context):
        super().__init__()
        self.ticks = 0

    def name(self):
        return "counter"

    @service(changes=False)
    def count(self):
        return self.ticks

    def default_action(self):
        self.ticks += 1


class Broken(Counter):
    def __init__(self, context):
        raise OSError("no line to the building")


class Simulation(Counter):
    def name(self):
        return "simulation"


class Robot(Counter):
    def name(self):
        return "robot"


class Dies(Counter):
    def name(self):
        return "dies"

    def default_action(self):
        raise RuntimeError("enough")


def good(scene):
    return [SceneWarning("no robot has an arm", scene.components[0].where)]


def endless(scene):
    return (SceneWarning(f"warning {number}") for number in itertools.count())


def raising(scene):
    raise KeyError("arm")


def words(scene):
    return "some words"


def nothing(scene):
    return None
'''
SCENE = """
from morse.builder import *
robot = FakeRobot()
Environment("empty")
"""


@pytest.fixture
def scene(tmp_path: Path) -> Path:
    """A script of a project; its `pyproject.toml` is written by `points`."""
    package = tmp_path / "src" / "lab"
    package.mkdir(parents=True)
    (package / "__init__.py").write_text(LAB)
    script = tmp_path / "default.py"
    script.write_text(SCENE)
    return script


def points(scene: Path, group: str, **values: str) -> Path:
    lines = [f'{name} = "{value}"\n' for name, value in values.items()]
    scene.with_name("pyproject.toml").write_text("".join([f'[project.entry-points."morse.{group}"]\n', *lines]))
    return scene


def test_a_service_is_called_and_acts_in_each_tick(scene: Path):
    with morse.load(points(scene, "services", counter="lab:Counter")) as sim:
        sim.step(10)
        assert sim.rpc("counter", "count") == 10


@pytest.mark.parametrize(
    ("name", "value", "reason"),
    [
        ("counter", "lab:Broken", "no line to the building"),
        ("counter", "lab:Absent", "Absent"),
        ("counter", "no_such_lab:Counter", "no_such_lab"),
        ("counter", "lab:good", "lab:good"),
        ("other", "lab:Counter", "expected that of the entry point, 'other'"),
        ("simulation", "lab:Simulation", "reserved"),
        ("robot", "lab:Robot", "there is already an object 'robot'"),
        ("a-b", "lab:Counter", "a word of up to 100 letters"),
    ],
)
def test_a_service_that_cannot_be_offered_is_named(
    scene: Path, name: str, value: str, reason: str, caplog: pytest.LogCaptureFixture
):
    with morse.load(points(scene, "services", **{name: value})) as sim:
        sim.step(2)
        assert sim.rpc("time", "now") > 0.0
        assert not sim.failures
    (text,) = [record.getMessage() for record in caplog.records if "the services of the package" in record.message]
    assert value in text
    assert reason in text
    with pytest.raises(SceneWarningError, match="the services of the package"):
        morse.load(scene, on_warning="raise")


def test_a_service_that_dies_is_switched_off_alone(scene: Path):
    with morse.load(points(scene, "services", counter="lab:Counter", dies="lab:Dies")) as sim:
        sim.step(5)
        assert [failure.part for failure in sim.failures] != []
        assert sim.rpc("counter", "count") == 5


def test_a_check_is_a_warning_with_its_line(scene: Path):
    with pytest.raises(SceneWarningError, match=r"default\.py:3: no robot has an arm"):
        morse.load(points(scene, "checks", arms="lab:good"), on_warning="raise")


@pytest.mark.parametrize("kind", ["raising", "words", "nothing", "absent"])
def test_a_check_that_fails_is_named_and_the_others_go_on(scene: Path, kind: str, caplog: pytest.LogCaptureFixture):
    with morse.load(points(scene, "checks", a=f"lab:{kind}", b="lab:good")) as sim:
        sim.step(2)
    assert f"the check 'a' (lab:{kind}) cannot be made" in caplog.text
    assert "no robot has an arm" in caplog.text
    returned = {"words": "'some words'", "nothing": "None"}
    assert kind not in returned or f"it returns {returned[kind]}, expected" in caplog.text


def test_a_check_with_endless_warnings_ends(scene: Path, caplog: pytest.LogCaptureFixture):
    caplog.set_level(logging.WARNING)
    with morse.load(points(scene, "checks", endless="lab:endless")) as sim:
        sim.step(2)
    assert caplog.text.count("warning 99") == 1
    assert "warning 100" not in caplog.text
