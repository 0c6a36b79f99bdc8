"""What a script wants to be shown."""

from collections.abc import Callable
from typing import Any

import pytest

from morse.builder.errors import ScriptError

SCRIPT = """
from morse.builder import *
robot = ATRV()
eye = VideoCamera()
robot.append(eye)
kinect = Kinect()
robot.append(kinect)
imu = IMU()
robot.append(imu)
laser = Hokuyo()
robot.append(laser)
ball = Sphere("ball")
env = Environment("empty")
"""


def test_names_and_objects_are_the_same(load: Callable[..., Any]) -> None:
    by_object = load(SCRIPT + "env.show(rays=[laser], images=[eye], follow=robot, select=imu)")
    by_name = load(
        SCRIPT + "env.show(rays=['robot.laser'], images=['robot.eye'], follow='robot', select='robot.imu')", name="b.py"
    )
    display = by_object.settings.view.display
    assert (display.rays, display.images) == (("robot.laser",), ("robot.eye",))
    assert (display.follow, display.select) == ("robot", "robot.imu")
    assert by_name.settings.view.display == display


def test_plots_are_fields_or_lists_of_fields(load: Callable[..., Any]) -> None:
    script = SCRIPT + "env.show(plots=['robot.imu.angular_velocity', ['robot.imu.linear_acceleration']])"
    display = load(script).settings.view.display
    assert display.plots == ((("robot.imu", "angular_velocity"),), (("robot.imu", "linear_acceleration"),))


def test_a_kinect_has_two_images(load: Callable[..., Any]) -> None:
    display = load(SCRIPT + "env.show(images=[kinect])").settings.view.display
    assert len(display.images) == 2
    assert all(name.startswith("robot.Kinect.") for name in display.images)


def test_an_object_is_followed(load: Callable[..., Any]) -> None:
    assert load(SCRIPT + "env.show(follow='ball')").settings.view.display.follow == "ball"


def test_all_rays_are_an_overlay(load: Callable[..., Any]) -> None:
    display = load(SCRIPT + "env.show(rays=True, overlays=['trails', 'rays'], layout=[])").settings.view.display
    assert display.overlays == ("rays", "trails")
    assert display.panels == ()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ("rays=['robot.lasr']", "did you mean 'robot.laser'"),
        ("rays=['laser']", "did you mean 'robot.laser'"),
        ("images=[imu]", "no camera 'robot.imu'"),
        ("images=['robot.eyes']", "did you mean 'robot.eye'"),
        ("plots=['robot.imu.angular_velocty']", "did you mean 'angular_velocity'"),
        ("plots=['robot.imy.angular_velocity']", "did you mean 'robot.imu'"),
        ("plots=['imu.angular_velocity']", "did you mean 'robot.imu'"),
        ("plots=['robot.imu']", "a field of 'robot.imu'"),
        ("plots='robot.imu.angular_velocity'", "takes a list"),
        ("follow='robt'", "did you mean 'robot'"),
        ("follow=3", "an object or its name"),
        ("select='robot.Imu'", "did you mean 'robot.imu'"),
        ("overlays=['trail']", "did you mean 'trails'"),
        ("layout=['trees']", "did you mean 'tree'"),
        ("images=eye", "takes a list"),
    ],
)
def test_mistakes_name_the_nearest_word_and_the_line(load: Callable[..., Any], arguments: str, message: str) -> None:
    with pytest.raises(ScriptError, match=message) as caught:
        load(SCRIPT + f"env.show({arguments})")
    assert caught.value.where is not None
    assert caught.value.where.line == SCRIPT.count("\n") + 1
