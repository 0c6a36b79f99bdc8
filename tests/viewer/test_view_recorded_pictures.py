"""What cameras saw in a recorded run, on the page of the replay."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import morse
from morse.launch.playing import playing
from morse.recording.recording import Recording
from morse.viewer.feeds.recorded import RecordedPicturesFeed

SCENE = """
from morse.builder import *

robot = ATRV()
motion = MotionVW()
robot.append(motion)
for name, camera in (("eye", VideoCamera()), ("depth", DepthVideoCamera()), ("ids", SegmentationCamera())):
    camera.name = name
    camera.translate(z=1.0)
    camera.rotate(x={turn})
    camera.properties(cam_width=24, cam_height=16)
    robot.append(camera)
env = Environment("sandbox")
{more}
"""
NAMES = ("eye", "depth", "ids")
#: ticks after which pictures are compared; the last ones go back
PLACES = (30, 60, 45, 12)


def written(path: Path, turn: float, more: str = "") -> Path:
    path.write_text(SCENE.format(turn=turn, more=more))
    return path


@pytest.mark.parametrize("more", ["", "env.configure_stream_manager('ros2', namespace='fleet/one')"])
def test_recorded_pictures_are_shown_whatever_the_scene_shows_now(tmp_path, more) -> None:
    script = written(tmp_path / "scene.py", 0.0, more)
    truth: dict[int, dict[str, np.ndarray]] = {}
    with morse.load(script) as sim, sim.record(tmp_path / "run.mcap"):
        sim.robot.motion.publish({"v": 1.0, "w": 1.0})
        for tick in range(1, 61):
            sim.step()
            components = sim.context.components
            if tick in PLACES:
                truth[tick] = {
                    name: np.array(components[f"robot.{name}"].local_data["image"])[
                        :: 1 if components[f"robot.{name}"].vertical_flip else -1
                    ]
                    for name in NAMES
                }
    assert any((truth[30]["eye"] != truth[60]["eye"]).ravel())
    # another scene: the cameras look elsewhere
    other = written(tmp_path / "other.py", 1.2, more)
    with (
        Recording(tmp_path / "run.mcap") as recording,
        playing(recording, str(other), print, port=0, browser=False) as view,
    ):
        feed: Any = view._pictures
        assert isinstance(feed, RecordedPicturesFeed)
        for place in PLACES:
            while not view._timeline.approach(place):
                pass
            for name in NAMES:
                component = view._simulation.context.components[f"robot.{name}"]
                shot = feed.shot(f"robot.{name}", component)
                np.testing.assert_array_equal(shot.image, truth[place][name])
                assert feed.shot(f"robot.{name}", component).source is shot.source


def test_cameras_that_were_not_recorded_are_those_of_the_simulation(tmp_path) -> None:
    script = written(tmp_path / "scene.py", 0.0)
    with morse.load(script) as sim, sim.record(tmp_path / "run.mcap", sensors=["robot.eye"]):
        sim.step(10)
    with Recording(tmp_path / "run.mcap") as recording, playing(recording, port=0, browser=False) as view:
        while not view._timeline.approach(10):
            pass
        feed: Any = view._pictures
        depth = view._simulation.context.components["robot.depth"]
        assert feed.shot("robot.depth", depth).source is depth.local_data["image"]
        eye = view._simulation.context.components["robot.eye"]
        assert feed.shot("robot.eye", eye).source is not eye.local_data["image"]
