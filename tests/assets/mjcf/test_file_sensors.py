"""Cameras and sensors of MJCF files."""

import math
from pathlib import Path

import pytest

import morse

MODEL = """<mujoco model="eye"><worldbody><body name="head" pos="0 0 1"><geom size="0.1"/><site name="here"/>
  <camera name="left" pos="0.2 0 0"/><camera name="right" pos="0.2 0 0"/></body></worldbody>
  <sensor><magnetometer site="here"/></sensor></mujoco>"""
SCENE = """
from morse.builder import *
robot = Robot({file!r})
env = Environment("empty")
"""


def test_cameras_take_pictures_once_somebody_reads_them_and_sensors_without_a_place_are_off(tmp_path: Path) -> None:
    (tmp_path / "eye.xml").write_text(MODEL)
    (tmp_path / "scene.py").write_text(SCENE.format(file=str(tmp_path / "eye.xml")))
    with morse.load(tmp_path / "scene.py") as sim:
        left, right = sim.robot.left, sim.robot.right
        sim.step(20)
        assert left.component._taken == right.component._taken == -1
        assert left.get()["image"].size > 0
        sim.step(20)
        assert left.component._taken > 0
        assert right.component._taken == -1
        assert not any(part.name().endswith("sensor0") for part in sim.context.components.values() if part.active)


def test_the_image_of_a_camera_has_the_size_and_the_view_of_the_file(tmp_path: Path) -> None:
    text = MODEL.replace('name="left"', 'name="left" fovy="60" resolution="320 160"')
    (tmp_path / "eye.xml").write_text(text.replace('name="right"', 'name="right" fovy="60"'))
    (tmp_path / "scene.py").write_text(SCENE.format(file=str(tmp_path / "eye.xml")))
    with morse.load(tmp_path / "scene.py") as sim:
        images = {}
        for camera in ("left", "right"):
            getattr(sim.robot, camera).get()
            sim.step(20)
            images[camera] = getattr(sim.robot, camera).get()
        assert images["left"]["image"].shape[:2] == (160, 320)
        # the same vertical field of view: 160 pixels for twice tan 30 degrees
        assert images["left"]["intrinsic_matrix"][0][0] == pytest.approx(80.0 / math.tan(math.radians(30.0)))
        height = images["right"]["image"].shape[0]
        assert images["right"]["intrinsic_matrix"][1][1] == pytest.approx(height / 2 / math.tan(math.radians(30.0)))
