"""The physics of objects from model files, as scripts set it."""

from pathlib import Path

import pytest
import trimesh

import morse

SCENE = """
from morse.builder import *
shelf = PassiveObject({file!r})
shelf.translate(3, 0, 2)
shelf.static()
crate = PassiveObject({file!r})
crate.translate(0, 0, 2)
crate.set_mass(7)
crate.set_friction(0.3)
crate.set_damping(0.0, 0.0)
env = Environment('empty', fastmode=True)
"""


def test_a_script_sets_the_physics_of_an_object(tmp_path: Path) -> None:
    trimesh.creation.box((0.4, 0.4, 0.4)).export(tmp_path / "box.glb")
    (tmp_path / "scene.py").write_text(SCENE.format(file=str(tmp_path / "box.glb")))
    with morse.load(tmp_path / "scene.py") as sim:
        shelf, crate = (sim.world.game_object(name) for name in ("shelf", "crate"))
        assert crate.mass == pytest.approx(7.0)
        sim.step(30)
        assert shelf.world_pose()[0][2] == 2.0
        # 0.5 s of free fall without damping
        assert crate.world_pose()[0][2] == pytest.approx(2.0 - 0.5 * 9.81 * 0.25, abs=0.03)
        sim.step(60)
        assert crate.world_pose()[0][2] == pytest.approx(0.2, abs=0.01)


def test_shares_are_from_0_to_1(tmp_path: Path) -> None:
    trimesh.creation.box((0.4, 0.4, 0.4)).export(tmp_path / "box.glb")
    script = f"from morse.builder import *\nPassiveObject({str(tmp_path / 'box.glb')!r}).set_restitution(2)\n"
    (tmp_path / "scene.py").write_text(script + "Environment('empty')\n")
    with pytest.raises(Exception, match=r"set_restitution\(restitution\) takes a number from 0 to 1, got 2"):
        morse.load(tmp_path / "scene.py")


def test_properties_without_effect_are_refused(tmp_path: Path) -> None:
    trimesh.creation.box((0.4, 0.4, 0.4)).export(tmp_path / "box.glb")
    script = f"from morse.builder import *\nPassiveObject({str(tmp_path / 'box.glb')!r}).properties(mass=7)\n"
    (tmp_path / "scene.py").write_text(script + "Environment('empty')\n")
    with pytest.raises(Exception, match=r"properties\(mass=...\) has no effect.*use set_mass\(\)"):
        morse.load(tmp_path / "scene.py")
