"""`morse export --film`: a film of a recorded run."""

import numpy as np
import pytest
from PIL import Image, ImageSequence

import morse as simulator
from morse.builder import FakeRobot, VideoCamera

SCENE = """
from morse.builder import *
robot = FakeRobot("robot")
cube = Cube("Load"); cube.scale = (0.5, 0.5, 0.5); cube.location = (0, 0, 1); cube.color(1, 0, 0)
robot.append(cube)
motion = MotionXYW("motion")
robot.append(motion)
env = Environment("empty", fastmode=True)
env.set_camera_location([0, 0, 21])
env.set_camera_rotation([0, 0, 0])
"""
SMALL = ("--size", "160x120", "--fov", "53.13010235415598")  # 10 m below, the picture is 20 m wide: 8 px/m
SPEED = 4.0


@pytest.fixture
def recording(morse):
    script = morse.directory / "scene.py"
    script.write_text(SCENE)
    with simulator.load(script) as sim, sim.record(morse.directory / "run.mcap", sensors=[]):
        sim.robot.motion.publish({"x": SPEED, "y": 0.0, "w": 0.0})
        sim.step(60)
    return "run.mcap"


def frames(path):
    with Image.open(path) as film:
        return [np.asarray(frame.convert("RGB")).astype(int) for frame in ImageSequence.Iterator(film)]


def column(image):
    found = (image[..., 0] > 100) & (image[..., 1] < 90) & (image[..., 2] < 90)
    return np.nonzero(found)[1].mean() + 0.5


def test_the_robot_moves_as_it_did(morse, recording):
    answer = morse("export", recording, "--film", "--rate", "4", *SMALL)
    assert answer.status == 0, answer.err
    assert "run.gif: 4 frames of 1 s" in answer.out
    shown = frames(morse.directory / "run.gif")
    assert len(shown) == 4
    assert shown[0].shape == (120, 160, 3)
    # the top of the cube is at 1.5 m, 19.5 m below the camera
    pixels = 160.0 / (2.0 * 0.5 * 19.5)
    places = [column(image) for image in shown]
    assert places[0] == pytest.approx(80.0, abs=1.0)
    assert np.diff(places) == pytest.approx([SPEED / 4 * pixels] * 3, abs=1.0)


def test_a_part_of_the_run_as_single_frames(morse, recording):
    options = ("--begin", "0.5", "--length", "0.25", "--rate", "12", "-o", "frame_%02d.png", "--from", "0,0,21")
    answer = morse("export", recording, "--film", *options, "--at", "0,0.001,0", *SMALL)
    assert answer.status == 0, answer.err
    assert sorted(path.name for path in morse.directory.glob("frame_*.png")) == [f"frame_{k:02d}.png" for k in range(3)]


def watcher():
    robot = FakeRobot()
    eye = VideoCamera()
    eye.properties(cam_width=32, cam_height=24)
    robot.append(eye)
    return robot


def test_a_camera_that_came_later_is_filmed_while_it_is_there(morse):
    script = morse.directory / "scene.py"
    script.write_text(SCENE.replace(", fastmode=True", ""))
    with simulator.load(script) as sim, sim.record(morse.directory / "run.mcap"):
        sim.step(30)
        sim.spawn("guest", watcher, (-5.0, 0.0, 1.0))
        sim.step(60)
        sim.delete("guest")
        sim.step(30)
    answer = morse("export", "run.mcap", "--film", "--rate", "4", "--camera", "guest.eye", "-o", "f_%d.png")
    assert answer.status == 0, answer.err
    # of two seconds, the camera is there for one
    assert "4 frames of 1 s, without 1 s in which there is no guest.eye" in answer.out
    assert len(list(morse.directory.glob("f_*.png"))) == 4


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--film", "--csv"], "--as FORM, --mcap, --film, --html or --foxglove-layout"),
        (["--film", "-o", "run.doc"], "-o: a film is a file that ends in .gif"),
        (["--film", "--rate", "0"], "--rate is a number of frames per second up to 1000, not 0"),
        (["--film", "--begin", "-1"], "--begin is a number of simulated seconds"),
        (["--film", "--length", "nan"], "--length is a number of simulated seconds, not nan"),
        (["--film", "--camera", "robot.eye", "--fov", "50"], "cannot be combined with --from, --at and --fov"),
        (["--film", "--camera", "robot.eye"], "There is no camera 'robot.eye'. The scene has none."),
        (["--film", "--begin", "5"], "The recording ends after 1 s, before the film begins"),
    ],
)
def test_mistakes_are_told(morse, recording, words, said):
    answer = morse("export", recording, *words)
    assert answer.status in (1, 2)
    assert said in " ".join(answer.err.split())
    assert "Traceback" not in answer.err
