"""Robots of other packages stand for five seconds, and their motors hold their joints."""

import importlib.util
import math
from pathlib import Path

import pytest

import morse
from morse.assets import load

pytestmark = pytest.mark.soak

_GYM, _SUITE = "gymnasium/envs/mujoco/assets", "dm_control/suite"
#: models that are free stand on their own feet or wheels; the others are fixed
FILES = [
    *(f"pybullet_data/{name}.urdf" for name in (
        "a1/a1", "aliengo/aliengo", "mini_cheetah/mini_cheetah", "laikago/laikago_toes_zup", "quadruped/minitaur",
        "quadruped/spirit40", "quadruped/vision60", "quadruped/quadruped", "r2d2", "racecar/racecar",
        "racecar/racecar_differential", "kuka_iiwa/model", "kuka_iiwa/model_free_base", "xarm/xarm6_robot",
        "xarm/xarm6_with_gripper", "franka_panda/panda", "pr2_gripper", "cartpole", "TwoJointRobot_wo_fixedJoints",
        "differential/diff_ring",
    )),
    *(f"{_GYM}/{name}.xml" for name in (
        "ant", "half_cheetah", "hopper", "inverted_double_pendulum", "inverted_pendulum", "reacher", "swimmer",
        "walker2d", "point",
    )),
    *(f"{_SUITE}/{name}.xml" for name in (
        "acrobot", "cartpole", "cheetah", "finger", "hopper", "humanoid", "manipulator", "pendulum", "quadruped",
        "stacker", "walker",
    )),
    "dm_control/third_party/kinova/jaco_arm.xml",
    "gymnasium_robotics/envs/assets/fetch/reach.xml",
    "gymnasium_robotics/envs/assets/hand/reach.xml",
]  # fmt: skip
#: their files have motors that are too weak, or a damping that is too strong, to move the first joint by 0.1 in 3 s
SLOW = ("point", "pendulum", "quadruped", "reach")
#: largest speed at rest, rad/s: weak motors of files may alternate between their limits, by less than 1 mrad
AT_REST = {"dm_control/suite/hopper.xml": 0.2}
SCENE = """
from morse.builder import *
robot = Robot({file!r})
robot.translate(z={height})
arm = Armature(armature_name={armature!r})
arm.control('position')
robot.append(arm)
joints = ArmaturePose()
arm.append(joints)
pose = Pose()
robot.append(pose)
env = Environment('empty')
"""


@pytest.mark.parametrize("name", FILES)
def test_it_stands_and_its_joints_answer(tmp_path: Path, name: str) -> None:
    package, _, inside = name.partition("/")
    spec = importlib.util.find_spec(package)
    assert spec is not None
    assert spec.submodule_search_locations
    file = Path(next(iter(spec.submodule_search_locations))) / inside
    armature = next(node for node in load(file).nodes() if node.bones)
    # the engine moves joints that begin outside of their limits to these limits
    start = {bone.name: min(max(bone.value, bone.low), bone.high) for bone in armature.bones}
    script = tmp_path / "scene.py"
    script.write_text(SCENE.format(file=str(file), height=0.5, armature=armature.name))
    with morse.load(script) as sim:
        sim.step(300)
        arm = sim.robot.arm
        names, values = arm.get_joints().result(), arm.joints.get()
        assert names
        for joint in names:
            assert values[joint] == pytest.approx(start[joint], abs=0.1), joint
        assert max(map(abs, arm.joints.get_velocities().result().values())) < AT_REST.get(name, 0.1)
        place = sim.robot.pose.get()
        assert all(math.isfinite(place[axis]) for axis in "xyz")
        before = values[names[0]]
        low, high = arm.get_IK_limits(names[0]).result()
        wanted = before + (0.1 if before + 0.1 < high else -0.1)
        assert low <= wanted <= high
        arm.publish({joint: wanted if joint == names[0] else start[joint] for joint in names})
        sim.step(180)
        if Path(name).stem not in SLOW:
            assert arm.joints.get()[names[0]] == pytest.approx(wanted, abs=0.03), "the joint has moved"
