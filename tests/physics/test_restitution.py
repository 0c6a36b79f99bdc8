"""Bodies bounce as scripts say, and slide with the friction that scripts set, on any ground."""

import math
from pathlib import Path

import pytest
import trimesh

import morse

SLOPE = """
<mujoco><worldbody>
  <geom name="ground" type="plane" size="50 50 1" euler="0 {angle} 0" friction="1"/>
</worldbody></mujoco>
"""


def _heights(tmp_path: Path, restitution: float, mesh: trimesh.Trimesh, height: float, bottom: float) -> list[float]:
    """The heights of the bounces of a body on the floor, m."""
    mesh.export(tmp_path / "body.obj")
    text = f"from morse.builder import *\nbody = PassiveObject({str(tmp_path / 'body.obj')!r})\n"
    text += f"body.translate(1, 0, {bottom + height})\nbody.set_restitution({restitution})\nbody.set_damping(0, 0)\n"
    (tmp_path / "scene.py").write_text(text + "env = Environment('empty', fastmode=True)\n")
    heights, speed = [], -1.0
    with morse.load(tmp_path / "scene.py") as sim:
        body = sim.world.game_object("body")
        for _ in range(300):
            sim.step(1)
            z, before = body.world_pose()[0][2] - bottom, speed
            speed = float(sim.world.data.qvel[2])
            if before > 0.0 >= speed:
                # the apex, within this tick
                heights.append(z + speed**2 / (2.0 * 9.81))
    return heights


def _rebound(tmp_path: Path, restitution: float, mesh: trimesh.Trimesh, height: float, bottom: float) -> float:
    """The ratio of the speeds after and before the impact of a body on the floor."""
    heights = _heights(tmp_path, restitution, mesh, height, bottom)
    return math.sqrt(max(heights[0], 0.0) / height) if heights else 0.0


@pytest.mark.parametrize("restitution", [0.0, 0.2, 0.3, 0.4, 0.6, 0.9])
@pytest.mark.parametrize("height", [0.6, 1.0, 1.37])
def test_balls_bounce_as_asked(tmp_path: Path, restitution: float, height: float) -> None:
    ball = trimesh.creation.icosphere(subdivisions=3, radius=0.15)
    assert _rebound(tmp_path, restitution, ball, height, 0.15) == pytest.approx(restitution, abs=0.05)


@pytest.mark.parametrize("restitution", [0.7, 0.8, 0.9])
@pytest.mark.parametrize("height", [0.5, 1.0])
def test_three_bounces_are_as_high_as_asked(tmp_path: Path, restitution: float, height: float) -> None:
    ball = trimesh.creation.icosphere(subdivisions=3, radius=0.15)
    heights = _heights(tmp_path, restitution, ball, height, 0.15)
    for number, reached in enumerate(heights[:3], 1):
        assert (reached / height) ** (0.5 / number) == pytest.approx(restitution, rel=0.008)


def test_a_box_of_another_mass_bounces_as_asked(tmp_path: Path) -> None:
    assert _rebound(tmp_path, 0.6, trimesh.creation.box((0.4, 0.4, 0.2)), 1.0, 0.1) == pytest.approx(0.6, abs=0.05)


@pytest.mark.parametrize(("angle", "friction"), [(28, 0.3), (36, 0.3), (36, 0.9)])
def test_the_friction_of_a_script_holds_on_the_ground_of_a_file(tmp_path: Path, angle: float, friction: float) -> None:
    (tmp_path / "slope.xml").write_text(SLOPE.format(angle=angle))
    trimesh.creation.box((0.4, 0.4, 0.1)).export(tmp_path / "block.obj")
    text = f"""
from morse.builder import *
block = PassiveObject({str(tmp_path / "block.obj")!r})
block.translate(0, 0, {0.051 / math.cos(math.radians(angle))})
block.rotate(0, {math.radians(angle)}, 0)
block.set_friction({friction})
block.set_damping(0, 0)
env = Environment({str(tmp_path / "slope.xml")!r}, fastmode=True)
"""
    (tmp_path / "scene.py").write_text(text)
    with morse.load(tmp_path / "scene.py") as sim:
        block = sim.world.game_object("block")
        sim.step(30)
        start = block.world_pose()[0]
        sim.step(60)
        path = math.dist(block.world_pose()[0], start)
    slope = math.radians(angle)
    acceleration = max(9.81 * (math.sin(slope) - friction * math.cos(slope)), 0.0)
    # from 0.5 s to 1.5 s
    assert path == pytest.approx(0.5 * acceleration * (1.5**2 - 0.5**2), rel=0.05, abs=0.01)
