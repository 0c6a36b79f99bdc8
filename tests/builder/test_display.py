"""What a script wants to be shown."""

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st

from morse.assets import search
from morse.builder import ATRV, DepthCamera, Environment, SemanticCamera, VideoCamera
from morse.builder.errors import ScriptError
from morse.mathutils import Euler
from tests.kit.effort import examples

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


# -- cameras that look at a point ------------------------------------------------------------------

NUMBER = st.floats(-20.0, 20.0)


def axes(camera: VideoCamera) -> np.ndarray:
    """(3, 3): right, down and forward of the image, in rows, in the frame of the robot."""
    return np.array([list(row) for row in Euler(camera.scene_node.rotation_euler).to_matrix()]).T


@pytest.mark.parametrize("kind", [VideoCamera, DepthCamera, SemanticCamera])
def test_straight_ahead_is_as_mounted(kind: type[VideoCamera]) -> None:
    mounted, turned = kind("mounted"), kind("turned")
    turned.translate(x=0.5, z=0.9)
    turned.look_at(3.0, 0.0, 0.9)
    assert axes(turned) == pytest.approx(axes(mounted), abs=1e-9)


@given(st.tuples(NUMBER, NUMBER, NUMBER), st.tuples(NUMBER, NUMBER, NUMBER))
@example((0.0004275207691126407, 0.0, 0.0), (0.0, 0.0, 1.0))
@example((1e-7, 0.0, 0.0), (0.0, 0.0, 1.0))
@settings(max_examples=examples(40), suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_the_point_is_in_the_centre_and_up_is_up(place: tuple[float, ...], point: tuple[float, ...]) -> None:
    way = np.subtract(point, place)
    if np.linalg.norm(way) < 1e-3:
        return
    camera = VideoCamera()
    camera.translate(*place)
    camera.look_at(*point)
    right, down, forward = axes(camera)
    assert forward == pytest.approx(way / np.linalg.norm(way), abs=1e-9)
    assert np.cross(right, down) == pytest.approx(forward, abs=1e-9)
    assert down[2] <= 1e-9
    if np.hypot(*way[:2]) > 1e-2 * np.linalg.norm(way):
        assert abs(right[2]) < 1e-9


def test_it_sees_what_it_looks_at() -> None:
    robot = ATRV()
    camera = VideoCamera()
    camera.translate(z=2.0)
    camera.look_at(0.0, 0.0, 0.0)  # the drone's camera that looks down
    robot.append(camera)
    Environment("empty")
    right, down, forward = axes(camera)
    assert forward == pytest.approx([0, 0, -1], abs=1e-9)
    assert down == pytest.approx([-1, 0, 0], abs=1e-9)  # ahead is at the upper edge of the image
    assert right == pytest.approx([0, -1, 0], abs=1e-9)


def test_wrong_points_are_refused() -> None:
    camera = VideoCamera()
    camera.translate(x=1.0)
    with pytest.raises(ValueError, match="another point"):
        camera.look_at(1.0, 0.0, 0.0)
    with pytest.raises(ValueError, match="finite"):
        camera.look_at(math.nan, 0.0, 0.0)


def test_an_environment_says_what_it_is() -> None:
    assert repr(Environment("empty")) == "<Environment 'empty'>"


# -- files of sounds are found as models are -------------------------------------------------------

SOUND_FILES_SCRIPT = """
from morse.builder import *
robot = FakeRobot("robot")
voice = Sound("voice")
voice.open("{name}")
robot.append(voice)
env = Environment("empty")
"""


def file_of(scene: Any) -> str:
    (voice,) = (part for part in scene.components if part.name == "robot.voice")
    return str(voice.node.properties["file"])


def test_a_sound_stands_beside_the_script(load: Callable[..., Any], tmp_path: Path) -> None:
    (tmp_path / "beep.wav").write_bytes(b"RIFF")
    assert file_of(load(SOUND_FILES_SCRIPT.format(name="beep.wav"))) == str((tmp_path / "beep.wav").resolve())


def test_a_sound_is_in_the_data_of_the_project(
    load: Callable[..., Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    data = tmp_path / "elsewhere"
    (data / "sim").mkdir(parents=True)
    (data / "sim" / "beep.wav").write_bytes(b"RIFF")
    monkeypatch.setenv("MORSE_RESOURCE_PATH", str(data))
    assert file_of(load(SOUND_FILES_SCRIPT.format(name="sim/beep.wav"))) == str((data / "sim" / "beep.wav").resolve())


def test_a_missing_sound_names_the_nearest_file_and_the_folders(load: Callable[..., Any], tmp_path: Path) -> None:
    (tmp_path / "beep.wav").write_bytes(b"RIFF")
    with pytest.raises(ScriptError, match=r"did you mean 'beep\.wav'") as caught:
        load(SOUND_FILES_SCRIPT.format(name="beeb.wav"))
    assert str(tmp_path) in str(caught.value)
    assert caught.value.where is not None
    assert caught.value.where.line == 5


def test_a_name_that_is_none_is_refused() -> None:
    with pytest.raises(ValueError, match="not the name of a file"):
        search.find_file(" ")
