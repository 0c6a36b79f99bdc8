"""Properties of cameras that change while the simulation runs, and values without an effect."""

import numpy as np
import pytest

from morse.core.exceptions import MorseRPCTypeError

SCRIPT = """
robot = FakeRobot("robot"); robot.translate(z=1.0)
small = {"cam_width": 16, "cam_height": 12}
depth = DepthCamera("depth"); depth.properties(cam_far=100.0, cam_fov=90.0, **small); robot.append(depth)
ids = SegmentationCamera("ids"); ids.properties(**small); robot.append(ids)
heat = ThermalCamera("heat"); heat.properties(**small); robot.append(heat)
both = DepthCameraAggregator("both")
for name, y in (("left", 0.5), ("right", -0.5)):
    one = DepthCamera(name); one.translate(y=y); one.properties(**small); both.append(one)
both.properties(master_camera="rigth"); robot.append(both)
noisy = VideoCamera("noisy"); noisy.properties(**small); noisy.noise(gaussian=5.0); robot.append(noisy)
wall = Cube("Wall"); wall.scale = (0.1, 20, 20); wall.location = (6.1, 0, 0)
wall.properties(Part=True, Kind="wall", Temperature="warm")
env = Environment("empty")
"""


@pytest.fixture
def world(simulate):
    simulation = simulate(SCRIPT, sockets=False)
    simulation.sleep(0.2)
    return simulation


def at_start(caplog):
    return "\n".join(record.getMessage() for record in caplog.get_records("setup"))


def test_the_rows_of_a_cloud(world, caplog):
    eye = world.context.component("robot.depth")
    eye.set_property("keep_list", "[1, 2, 99]")
    world.sleep(0.1)
    assert eye.local_data["nb_points"] == 2 * 16
    assert "keep_list contains the row 99; the image has the rows 0 to 11" in caplog.text
    with pytest.raises(MorseRPCTypeError, match=r"keep_list lists rows of the image, such as '\[1, 17, 34\]'"):
        eye.set_property("keep_list", "[top]")
    eye.set_property("keep_list", None)
    world.sleep(0.1)
    assert eye.local_data["nb_points"] == 12 * 16


def test_the_objects_and_classes_of_an_image_of_ids(world):
    eye = world.context.component("robot.ids")

    def classes():
        world.sleep(0.1)
        return {row["name"]: (row["class"], row["class_id"]) for row in eye.local_data["labels"]}

    assert classes()["robot"] == ("robot", 1)
    eye.set_property("class_names", "crate, robot")
    assert classes()["robot"] == ("robot", 2)
    eye.set_property("class_tag", "Kind")
    assert classes()["Wall"] == ("wall", 3)
    # the wall covers the middle
    assert eye.local_data["classes"][6, 8] == 3


def test_the_master_of_a_cloud(world, caplog):
    both = world.context.component("robot.both")
    assert "it has no depth camera 'rigth', which 'master_camera' names; did you mean 'right'?" in at_start(caplog)
    with pytest.raises(MorseRPCTypeError, match="did you mean 'left'"):
        both.set_property("master_camera", "lefft")
    middles = {}
    for name in ("left", "right"):
        both.set_property("master_camera", name)
        world.sleep(0.1)
        middles[name] = both.local_data["points"][:, 0].mean()
    # X is to the right: seen from the left camera, all points are a metre farther to the right
    assert middles["left"] - middles["right"] == pytest.approx(1.0, abs=1e-3)


def test_values_without_an_effect_are_named(world, caplog):
    assert "robot.noisy: noise() without a field has no effect" in at_start(caplog)
    assert "Wall: the property 'Temperature' is a number of degrees Celsius, not 'warm'" in at_start(caplog)
    assert np.unique(world.context.component("robot.heat").local_data["image"]).tolist() == [15.0]
