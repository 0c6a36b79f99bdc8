"""Messages of joints that the physics moves have velocities and efforts; commands match the control of the motors."""

from pathlib import Path

import pytest

import morse
from morse.core.kinds import bind

ROBOT = """<robot name="post"><link name="world"/><link name="flag"><inertial><origin xyz="0.5 0 0"/><mass value="1"/>
  <inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="wave" type="continuous"><parent link="world"/><child link="flag"/><axis xyz="0 0 1"/></joint></robot>"""
SCENE = """
from morse.builder import *
post = Robot({file!r})
mast = Armature(armature_name='post_joints')
mast.control({control!r})
post.append(mast)
state = ArmaturePose()
mast.append(state)
env = Environment('empty')
"""


@pytest.mark.parametrize("control", ["position", "velocity", "effort"])
def test_the_slots_of_joints(tmp_path: Path, control: str) -> None:
    file, script = tmp_path / "post.urdf", tmp_path / "scene.py"
    file.write_text(ROBOT)
    script.write_text(SCENE.format(file=str(file), control=control))
    with morse.load(script) as sim:
        sim.post.mast.publish({"wave": 0.5})
        sim.step(60)
        (command,) = [one for one in bind(sim.context.component("post.mast")) if one.kind.name == "joints"]
        assert {slot for slot in ("position", "velocity", "effort") if command.has(slot)} == {control}
        assert command.scatter({control: [0.7]}) == ({"wave": 0.7}, None)
        (measured,) = bind(sim.context.component("post.mast.state"))
        message = measured.gather()
        assert list(message.names) == ["wave"]
        if control == "effort":
            # 0.5 N m turn 1 kg at 0.5 m, and its own 0.01 kg m^2
            assert message.effort[0] == pytest.approx(0.5)
            assert message.velocity[0] == pytest.approx(0.5 / 0.26, rel=1e-3)
        elif control == "velocity":
            assert message.velocity[0] == pytest.approx(0.5, rel=1e-3)
            assert message.position[0] == pytest.approx(0.5, rel=0.05)
        else:
            assert message.position[0] == pytest.approx(0.5, abs=2e-3)
