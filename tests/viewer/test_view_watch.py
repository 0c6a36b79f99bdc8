"""Messages to a page when files are saved while the simulation runs."""

import os
import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest
from driving_page import DrivingPage

import morse
from morse.viewer import page_messages as page

DATA = Path(morse.__file__).parent / "data"
COMPONENT = """
from morse.core.sensor import Sensor

class Ears(Sensor):
    _name = "Ears"
    _short_desc = "Hear"
"""
SCENE = """
from morse.builder import *
from proj.builder.sensors import Ears
robot = GroundRobot("mine.blend")
ears = Ears()
robot.append(ears)
env = Environment("empty", fastmode=True)
"""


@pytest.fixture
def shown(tmp_path: Path) -> Iterator[DrivingPage]:
    for folder in ("src/proj/sensors", "src/proj/builder", "data/robots"):
        (tmp_path / folder).mkdir(parents=True)
    for package in ("proj", "proj/sensors", "proj/builder"):
        (tmp_path / "src" / package / "__init__.py").touch()
    (tmp_path / "src/proj/sensors/ears.py").write_text(COMPONENT)
    (tmp_path / "src/proj/builder/sensors.py").write_text("from proj.sensors.ears import Ears\n")
    shutil.copy(DATA / "robots" / "morsy.blend", tmp_path / "data/robots/mine.blend")
    script = tmp_path / "scene.py"
    script.write_text(SCENE)
    with morse.load(script, view="web", watch=True) as simulation:
        looking = DrivingPage(simulation)
        yield looking
        looking.close()


@pytest.mark.parametrize("paused", [True, False])
def test_a_mistake_in_a_component_is_in_the_log_of_the_page(shown: DrivingPage, tmp_path: Path, paused: bool) -> None:
    shown.send(page.Pause() if paused else page.Play())
    path = tmp_path / "src/proj/sensors/ears.py"
    path.write_text(COMPONENT + "\n    def default_action(self)\n        pass\n")
    shown.until(lambda: any("SyntaxError" in line and str(path) in line and "line 8" in line for line in shown.log))


def test_a_page_gets_the_new_model_and_a_new_past(shown: DrivingPage, tmp_path: Path) -> None:
    shown.send(page.Play())
    shown.until(lambda: len(shown.times) > 4)
    shown.send(page.Pause())
    shown.until(lambda: shown.simulation.paused and shown.worlds)
    worlds, before = shown.worlds, shown.simulation.time()
    shutil.copy(DATA / "robots" / "atrv.blend", tmp_path / "new")
    os.replace(tmp_path / "new", tmp_path / "data/robots/mine.blend")
    shown.until(lambda: shown.worlds > worlds)
    shown.until(lambda: all(time >= before - 1e-9 for time in shown.times))
    node = shown.simulation.scene.find("robot")
    assert node is not None
    assert any("wheel" in part.name.lower() for part in node.walk())
