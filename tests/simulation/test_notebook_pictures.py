"""The images of cameras in a notebook."""

import io

import numpy as np
import pytest
from PIL import Image

import morse
from morse.rendering import photograph

SMALL = {"cam_width": 24, "cam_height": 16}


def scene():
    from morse.builder import Cube, Environment, FakeRobot, Pose, sensors

    robot = FakeRobot("robot")
    robot.translate(z=1.0)
    for kind in ("VideoCamera", "DepthVideoCamera", "SegmentationCamera", "ThermalCamera", "NormalCamera"):
        camera = getattr(sensors, kind)(kind)
        camera.properties(**SMALL)
        robot.append(camera)
    robot.append(Pose("pose"))
    wall = Cube("Wall")
    # the lower half of the image
    wall.scale, wall.location = (0.1, 20, 0.5), (6.1, 0, 0.5)
    wall.properties(Temperature=40.0)
    Environment("empty")


@pytest.fixture(scope="module")
def sim():
    with morse.load(scene) as simulation:
        simulation.step(6)
        yield simulation


def shown(camera):
    with Image.open(io.BytesIO(camera._repr_png_())) as picture:
        assert picture.format == "PNG"
        return np.asarray(picture.convert("RGB"))


def test_colours_are_those_of_the_data(sim):
    camera = sim.robot.VideoCamera
    np.testing.assert_array_equal(shown(camera), camera.data["image"][..., :3])


@pytest.mark.parametrize("kind", ["DepthVideoCamera", "SegmentationCamera", "ThermalCamera", "NormalCamera"])
def test_what_is_not_a_colour_has_colours_with_the_top_row_first(sim, kind):
    pixels = shown(getattr(sim.robot, kind)).astype(int)
    assert pixels.shape == (16, 24, 3)
    # the wall is brighter than the sky
    assert pixels[11, 12].sum() > pixels[2, 12].sum()


def test_a_camera_without_an_image_says_when_there_is_one():
    with morse.load(scene) as simulation:
        camera = simulation.robot.VideoCamera
        assert camera._repr_png_() is None
        assert "no image before sim.step()" in repr(camera)
        simulation.step(6)
        assert "no image" not in repr(camera)


def test_other_components_are_shown_as_text(sim):
    assert sim.robot.pose._repr_png_() is None
    assert sim.robot._repr_png_() is None


# -- pictures of the world that follow each other --------------------------------------------------


def pictures_scene():
    from morse.builder import ATRV, Cube, Environment

    ATRV("robot")
    crate = Cube("Crate")
    crate.location = (2.0, 0.0, 0.5)
    crate._bpy_object.game.physics_type = "RIGID_BODY"
    Environment("empty")


def test_a_later_picture_is_as_the_first_of_its_world():
    with morse.load(pictures_scene) as sim:
        changes = [
            lambda: sim.step(10),
            lambda: sim.place("Crate", [1.0, 1.0, 0.7]),
            lambda: sim.rpc("simulation", "set_object_visibility", "Crate", False, False),
            lambda: sim.spawn("more", "props/crates", (3.0, 1.0, 0.5)),
            sim.restart,
        ]
        before = sim.picture(96, 60)
        for change in changes:
            change()
            picture = sim.picture(96, 60)
            assert (picture == photograph(sim.world, 96, 60)).all()
        assert (sim.picture(50, 40, location=[1.0, 0.0, 9.0], rotation=[0.0, 0.0, 0.0]).shape) == (40, 50, 3)
        sim.place("Crate", [0.0, 2.0, 0.0])
        assert (sim.picture(96, 60) != before).any()
