"""The first lines of the chapter on models work with a file of each format."""

import re
from pathlib import Path

import pytest

import morse

HERE = Path(__file__).parent
CHAPTER = HERE.parents[1] / "docs" / "models.md"
MJCF = """<mujoco model="walker"><worldbody><geom type="plane" size="5 5 .1"/><body name="base" pos="0 0 .5">
<freejoint/><geom type="box" size=".2 .2 .05" mass="2"/><body name="leg" pos="0 0 -.05">
<joint name="knee" axis="0 1 0" range="-1 1" limited="true"/>
<geom type="capsule" fromto="0 0 0 0 0 -.2" size=".02" mass=".2"/></body></body></worldbody>
<actuator><motor joint="knee"/></actuator><keyframe><key name="home" qpos="0 0 0.6 1 0 0 0 0.3"/></keyframe></mujoco>"""
CUBE = [(x, y, z) for x in (-0.2, 0.2) for y in (-0.2, 0.2) for z in (-0.2, 0.2)]
FACES = ((1, 2, 4, 3), (5, 7, 8, 6), (1, 5, 6, 2), (3, 4, 8, 7), (1, 3, 7, 5), (2, 6, 8, 4))


def lines(word: str) -> str:
    text = CHAPTER.read_text("utf-8").split("\n## ")[0]
    (code,) = (part for part in re.findall(r"```python\n(.*?)```", text, re.DOTALL) if word in part)
    assert len(code.strip().splitlines()) <= 5
    return code


@pytest.fixture
def run(tmp_path, monkeypatch):
    for folder in ("urdf", "sdf"):
        monkeypatch.syspath_prepend(str(HERE / folder))

    def load(word: str, **files: str):
        for name, text in files.items():
            (tmp_path / name.replace("_", ".")).write_text(text)
        (tmp_path / "scene.py").write_text(f"from morse.builder import *\n{lines(word)}")
        return morse.load(tmp_path / "scene.py")

    return load


def test_a_urdf_drives(run) -> None:
    import test_urdf_drives as urdf

    with run("rover.urdf", rover_urdf=f'<robot name="rover">{urdf.CART}</robot>') as simulation:
        simulation.step(60)
        simulation.robot.motion.publish({"v": 0.5, "w": 0.0})
        simulation.step(240)
        assert simulation.robot.component.position_3d.x > 1.5


def test_an_mjcf_starts_at_home(run) -> None:
    with run("walker.xml", walker_xml=MJCF) as simulation:
        simulation.step(1)
        assert simulation.robot.component.position_3d.z == pytest.approx(0.6, abs=0.01)
        simulation.step(60)
        assert simulation.robot.joints.get_controls().result()["knee"] == "position"


def test_an_sdf_drives_in_its_world(run) -> None:
    import test_sdf_plugins as sdf
    import test_sdf_worlds as worlds

    world = f'<sdf version="1.9"><world name="w">{worlds.GROUND}</world></sdf>'
    with run("cart.sdf", cart_sdf=sdf.CART, warehouse_sdf=world) as simulation:
        simulation.step(60)
        simulation.robot.motion.publish({"v": 0.5, "w": 0.0})
        simulation.step(240)
        assert simulation.robot.component.position_3d.x > 1.5


def test_a_mesh_falls_and_lies(run) -> None:
    text = "".join(f"v {x} {y} {z}\n" for x, y, z in CUBE) + "".join(f"f {a} {b} {c} {d}\n" for a, b, c, d in FACES)
    with run("chair.obj", chair_obj=text) as simulation:
        simulation.step(240)
        (chair,) = (one for one in simulation.world.objects() if one.name == "chair")
        assert chair.world_pose()[0][2] == pytest.approx(0.2, abs=0.01)
