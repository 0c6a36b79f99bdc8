"""FollowJointTrajectory, called by a real node in another process."""

import subprocess
import sys
from pathlib import Path

import pytest
from other_side import DOMAIN, PYTHON, has, lent, need, talk

import morse

#: an arm that swings about the vertical axis, so that weights do not matter, and a wall on its left
URDF = """
<robot name="scara">
  <link name="world"/>
  <joint name="mount" type="fixed"><parent link="world"/><child link="base"/><origin xyz="0 0 0.5"/></joint>
  <link name="base"><inertial><mass value="5"/><inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/>
    </inertial><collision><geometry><cylinder radius="0.05" length="0.1"/></geometry></collision></link>
  <joint name="shoulder" type="revolute"><parent link="base"/><child link="upper"/><axis xyz="0 0 1"/>
    <limit lower="-3" upper="3" effort="40" velocity="3"/></joint>
  <link name="upper"><inertial><origin xyz="0.2 0 0"/><mass value="1"/>
    <inertia ixx="0.001" iyy="0.02" izz="0.02" ixy="0" ixz="0" iyz="0"/></inertial>
    <collision><origin xyz="0.25 0 0"/><geometry><box size="0.3 0.04 0.04"/></geometry></collision></link>
  <joint name="elbow" type="revolute"><parent link="upper"/><child link="lower"/><origin xyz="0.4 0 0"/>
    <axis xyz="0 0 1"/><limit lower="-3" upper="3" effort="20" velocity="3"/></joint>
  <link name="lower"><inertial><origin xyz="0.15 0 0"/><mass value="0.5"/>
    <inertia ixx="0.001" iyy="0.005" izz="0.005" ixy="0" ixz="0" iyz="0"/></inertial>
    <collision><origin xyz="0.15 0 0"/><geometry><box size="0.3 0.04 0.04"/></geometry></collision></link>
  <joint name="lift" type="prismatic"><parent link="lower"/><child link="tool"/><origin xyz="0.3 0 0"/>
    <axis xyz="0 0 1"/><limit lower="-0.2" upper="0.2" effort="50" velocity="1"/></joint>
  <link name="tool"><inertial><mass value="0.2"/><inertia ixx="0.001" iyy="0.001" izz="0.001" ixy="0" ixz="0"
    iyz="0"/></inertial></link>
</robot>
"""
SCENE = """
from pathlib import Path
from morse.builder import *
robot = Robot(str(Path(__file__).with_name("scara.urdf")), name="robot")
arm = Armature("arm", armature_name="scara_joints")
robot.append(arm)
wall = Cube("wall")
wall.scale = (0.25, 0.55, 1.0)
wall.translate(-0.4, 0.65, 0.5)
wall._bpy_object.game.physics_type = "STATIC"
robot.add_default_interface("ros2")
env = Environment("empty", fastmode=True)
env.configure_stream_manager("ros2", domain_id={domain}, backend="rclpy")
"""
SUCCEEDED, CANCELED, ABORTED = 4, 5, 6  # action_msgs/GoalStatus
INVALID_GOAL, PATH_VIOLATED, GOAL_VIOLATED = -1, -4, -5  # control_msgs/FollowJointTrajectory

if has(sys.executable, "rclpy"):

    def test_a_planner_follows_trajectories(tmp_path: Path) -> None:
        (tmp_path / "scara.urdf").write_text(URDF)
        (tmp_path / "scene.py").write_text(SCENE.format(domain=DOMAIN))
        with morse.load(tmp_path / "scene.py", sockets=True) as sim:
            said = talk("trajectory_peer.py", sim.step)
        assert said["reached"] == [SUCCEEDED, 0, ""]
        assert said["names"] == ["elbow", "shoulder"]
        feedback = said["feedback"]
        assert 8 <= len(feedback) <= 11, "five times per second for two seconds"
        for desired, actual, error in feedback:
            # a straight line from the start to both goals, which the motors follow
            assert desired[1] == pytest.approx(-0.8 * desired[0], abs=1e-6)
            assert error == pytest.approx([a - b for a, b in zip(desired, actual, strict=True)], abs=1e-9)
            assert error == pytest.approx([0.0, 0.0], abs=0.02)
        # 0.5 rad and -0.4 rad in two seconds
        assert said["velocities"][len(feedback) // 2] == pytest.approx([0.25, -0.2], abs=0.1)
        assert said["stamps"] == sorted(said["stamps"])
        assert said["preempted"][:2] == [CANCELED, INVALID_GOAL]
        assert said["cancelling"] == 1
        assert said["cancelled"][0] == CANCELED
        assert said["blocked"][:2] == [ABORTED, PATH_VIOLATED]
        assert "the position of 'shoulder' differs by" in said["blocked"][2]
        assert said["back"][0] == SUCCEEDED
        assert said["late"][:2] == [ABORTED, GOAL_VIOLATED]
        assert said["accepted"] == [False] * 4

else:

    @pytest.mark.timeout(200)
    def test_by_the_python_that_has_rclpy() -> None:
        need("control_msgs.action", PYTHON)
        command = [PYTHON, "-m", "pytest", "-n0", "-q", "-p", "no:cacheprovider", "-k", "planner", __file__]
        done = subprocess.run(command, env=lent(), capture_output=True, text=True, timeout=180, check=False)
        assert done.returncode == 0, done.stdout[-4000:] + done.stderr[-2000:]
        assert "1 passed" in done.stdout
