"""Cameras and sensors of MJCF files."""

from __future__ import annotations

from typing import TYPE_CHECKING

import morse

if TYPE_CHECKING:
    from pathlib import Path

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
