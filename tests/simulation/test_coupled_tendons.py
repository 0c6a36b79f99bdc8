"""Two tendons whose lengths an MJCF file couples, in a world whose other bodies have fallen asleep."""

from pathlib import Path

import pytest

import morse
from morse.builder import Armature, ArmaturePose, Environment, Robot

#: the length of the second tendon is 0.1 m plus half of the change of the first
MJCF = """<mujoco model="rig"><worldbody><body name="frame" pos="0 0 1"><inertial pos="0 0 0" mass="1"
    diaginertia="1 1 1"/>
  <body name="left"><joint name="a" type="slide" axis="1 0 0"/><geom size="0.05" mass="1"/></body>
  <body name="right" pos="0 1 0"><joint name="b" type="slide" axis="1 0 0"/><geom size="0.05" mass="1"/></body>
  </body></worldbody>
  <tendon>
    <fixed name="first"><joint joint="a" coef="2"/></fixed>
    <fixed name="second"><joint joint="b" coef="1"/></fixed>
  </tendon>
  <equality><tendon tendon1="second" tendon2="first" polycoef="0.1 0.5 0 0 0"/></equality>
</mujoco>"""


def rig(file: Path) -> Robot:
    robot = Robot(str(file))
    arm = Armature("arm", armature_name="rig_joints")
    robot.append(arm)
    arm.append(ArmaturePose("state"))
    return robot


def test_they_are_coupled_and_the_others_sleep_again_after_a_deletion(tmp_path: Path) -> None:
    file = tmp_path / "rig.xml"
    file.write_text(MJCF)
    with morse.load(lambda: Environment("empty")) as sim:
        sim.spawn("crate", "props/crates", (-5.0, 0.0, 0.5))
        sim.step(300)
        assert sim.context.world.data.nv_awake == 0
        sim.spawn("rig", lambda: rig(file), position=(3.0, 0.0, 0.0))
        sim.rig.arm.set_control("position", ["a"]).result()
        sim.rig.arm.publish({"a": 0.3})
        sim.step(600)
        values = sim.rig.arm.state.get()
        assert values["a"] == pytest.approx(0.3, abs=5e-3)
        assert values["b"] == pytest.approx(0.1 + 0.5 * (2 * values["a"]), abs=5e-3)
        sim.save()
        sim.delete("rig")
        sim.step(300)
        assert sim.context.world.data.nv_awake == 0
