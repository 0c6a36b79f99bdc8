"""A recorded run is shown from the file alone: without the script, the modules and the models of its project."""

import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

import morse
from morse.launch.playing import playing
from morse.recording.recording import Recording
from morse.sensors.pose import Pose
from morse.viewer.describe import describe
from morse.viewer.feeds.components import component_tree
from morse.viewer.replay_view import ReplayView
from morse.viewer.site import AssetStore

SENSORS = """
from morse.core.declarations import add_data
from morse.core.sensor import Sensor
from morse.sensors.pose import Pose


class Sonar(Sensor):
    _name = "Sonar"
    _short_desc = "Measures a depth"
    add_data("depth", 2.5, "float", "Depth of the water", unit="m", low=0.0, high=90.0)

    def default_action(self):
        self.local_data["depth"] = self.clock.time


class Finer(Pose):
    _name = "Finer"
"""
SCENE = """
from morse.builder import *
from own_sensors import Finer, Sonar

robot = ATRV()
sonar, finer, motion = Sonar(), Finer(), MotionVW()
for part in (sonar, finer, motion):
    robot.append(part)
env = Environment("empty", fastmode=True)
env.set_camera_location([1, 2, 3])
env.set_horizon_color((0.1, 0.2, 0.3))
env.properties(longitude=1.5)
"""
TRIANGLE = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"


class Shown:
    """A run that was recorded in a folder that does not exist any more."""

    def __init__(self, path: Path, folder: Path) -> None:
        (folder / "own_sensors.py").write_text(SENSORS)
        (folder / "scene.py").write_text(SCENE)
        (folder / "thing.obj").write_text(TRIANGLE)
        self.path = path
        with morse.load(folder / "scene.py", seed=3) as sim, sim.record(path):
            self.launch = self.look(sim)
            self.tree = component_tree(sim.context)
            sim.step(3)
            sim.spawn("thing", str(folder / "thing.obj"), (2.0, 1.0, 0.5))
            sim.robot.motion.publish({"v": 1.0})
            sim.step(9)
            self.end = self.look(sim)
        shutil.rmtree(folder)

    @staticmethod
    def look(sim: Any) -> Any:
        """What a page gets of the scene."""
        return describe(sim.scene, [], 0, AssetStore(), key="")


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Shown:
    folder = tmp_path_factory.mktemp("project")
    return Shown(tmp_path_factory.mktemp("kept") / "run.mcap", folder)


@pytest.fixture(scope="module")
def view(run: Shown) -> Iterator[ReplayView]:
    with Recording(run.path) as recording, playing(recording, port=0, browser=False) as shown:
        yield shown


def test_the_page_gets_the_same_scene(run: Shown, view: ReplayView) -> None:
    simulation = view._simulation
    view._timeline.approach(0)
    assert run.look(simulation) == run.launch
    view._timeline.approach(12)
    assert "thing" in simulation.world.objects_by_name, "its model is not needed"
    assert {node.name for node in run.look(simulation).nodes} == {node.name for node in run.end.nodes}
    assert simulation.scene.properties == {"longitude": 1.5}


def test_panels_have_the_fields_of_classes_that_are_not_there(run: Shown, view: ReplayView) -> None:
    view._timeline.approach(12)
    before = {one.name: one for one in run.tree}
    after = {one.name: one for one in component_tree(view._simulation.context)}
    assert after["robot"] == before["robot"]
    assert after["robot.motion"] == before["robot.motion"]
    sonar = after["robot.sonar"]
    assert (sonar.title, sonar.doc) == ("Sonar", "Measures a depth")
    assert sonar.data == before["robot.sonar"].data
    components = view._simulation.context.components
    assert type(components["robot.finer"]) is Pose
    feed: Any = view._feeds[0]
    data, note = feed.measured("robot.sonar")
    assert not note
    # the last message is that of the beginning of the tick
    assert data["depth"] == pytest.approx(12 / 60, abs=2 / 60)
    data, _ = feed.measured("robot.finer")
    assert data["x"] > 0.0
