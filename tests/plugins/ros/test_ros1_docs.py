"""The scene and the node of the documentation, and a test case in the style of MORSE 1.4."""

import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from master import environment, master, need_ros, run, simulation

from tests.kit.programs import free_port

BLOCKS = (Path(__file__).parents[3] / "docs" / "ros1.md").read_text(encoding="utf-8").split("```python\n")[1:]
CASE = """
import sys

import rospy
from geometry_msgs.msg import PoseStamped, Twist

from morse.testing.ros import RosTestCase
from morse.testing.testing import testlogger

try:
    from morse.builder import *
except ImportError:
    pass


class DriveTest(RosTestCase):
    def setUpEnv(self):
        robot = ATRV("robot")
        pose = Pose("pose")
        pose.add_stream("ros")
        robot.append(pose)
        motion = MotionVW("motion")
        motion.add_stream("ros")
        robot.append(motion)
        env = Environment("empty", fastmode=True)
        env.add_service("socket")

    def test_drive(self):
        rospy.init_node("morse_ros_testing", log_level=rospy.DEBUG, disable_signals=True)
        wheels = rospy.Publisher("/robot/motion", Twist, queue_size=1)
        twist = Twist()
        twist.linear.x = 1.0
        start = rospy.wait_for_message("/robot/pose", PoseStamped, 30).pose.position.x
        while rospy.wait_for_message("/robot/pose", PoseStamped, 30).pose.position.x < start + 0.5:
            wheels.publish(twist)


if __name__ == "__main__":
    from morse.testing.testing import main

    main(DriveTest, time_modes=[TimeStrategies.BestEffort])
"""


@pytest.mark.slow
def test_the_node_of_the_documentation_drives_the_robot(tmp_path: Path) -> None:
    need_ros()
    scene, client = (block.partition("```")[0] for block in BLOCKS[:2])
    (tmp_path / "default.py").write_text(scene)
    (tmp_path / "client.py").write_text(client)
    with master() as uri, simulation(tmp_path / "default.py", uri):
        assert "odometry 0.5 m" in run(tmp_path / "client.py", uri)


@pytest.mark.slow
@pytest.mark.timeout(300)
def test_a_test_case_of_1_4_starts_a_master_and_passes(tmp_path: Path) -> None:
    need_ros()
    if shutil.which("roscore") is None:
        pytest.fail("roscore is missing: apt install python3-roslaunch")
    (tmp_path / "case.py").write_text(CASE)
    variables = environment(f"http://127.0.0.1:{free_port()}/")
    done = subprocess.run(
        [sys.executable, "case.py"],
        cwd=tmp_path, env={**variables, "ROS_LOG_DIR": str(tmp_path)}, capture_output=True, text=True, timeout=280,
        check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout[-3000:] + done.stderr[-3000:]
    assert "OK" in done.stdout + done.stderr
