"""Commands as their senders have them: with a stamp or without, one point or several."""

import subprocess
import sys
from pathlib import Path

import pytest
from other_side import DOMAIN, PYTHON, SETTINGS, has, lent, need, talk

import morse
from morse.rosmsgs.table import Qos

SCENE = """
from morse.builder import *
robot = ATRV()
robot.append(MotionVW("motion"))
robot.append(Odometry("path"))
arm = KukaLWR("arm")
robot.append(arm)
arm.append(ArmaturePose("pose"))
robot.add_default_interface("ros2")
env = Environment("empty", fastmode=True)
env.configure_stream_manager("ros2", domain_id={domain}, backend="{backend}")
"""
BACKENDS = [backend for backend in ("cyclonedds", "rclpy") if has(sys.executable, backend)]


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.peer("ros-jazzy-rclpy", does="commands as Twist, TwistStamped, AckermannDrive")
def test_a_node_decides_how_it_commands(backend: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    need("rclpy", PYTHON)
    for name in SETTINGS:
        monkeypatch.delenv(name, raising=False)
    (tmp_path / "scene.py").write_text(SCENE.format(domain=DOMAIN, backend=backend))
    with morse.load(tmp_path / "scene.py", sockets=True) as sim:
        said = talk("commands_peer.py", sim.step, PYTHON)
    assert said["speeds"] == pytest.approx([0.3, 0.6, 0.9], abs=0.03)
    # from rest at 0 to 0.4 within 1 s, and on to -0.4 within 2 s more, in simulated time
    stamps, angles = zip(*said["joint"], strict=True)
    top = max(angles)
    assert top == pytest.approx(0.4, abs=0.02)
    at_top = stamps[angles.index(top)]
    middle = min(range(len(stamps)), key=lambda index: abs(stamps[index] - at_top - 1.0))
    assert angles[middle] == pytest.approx(0.0, abs=0.05), "halfway after half of the two seconds"
    assert stamps[-1] - at_top == pytest.approx(2.0, abs=0.1)


def test_a_type_that_no_command_has_is_reported(
    tmp_path: Path, caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    need("cyclonedds")
    monkeypatch.delenv("CYCLONEDDS_URI", raising=False)
    from morse.middleware.ros2.backends.cyclone import CycloneBackend

    (tmp_path / "scene.py").write_text(SCENE.format(domain=DOMAIN, backend="cyclonedds"))
    with morse.load(tmp_path / "scene.py", sockets=True) as sim:
        sim.step(300)
        assert "somebody sends" not in caplog.text
        other = CycloneBackend({"domain_id": DOMAIN, "interface": "lo"})
        publisher = other.publisher("/robot/cmd_vel", "geometry_msgs/msg/PoseStamped", Qos())
        for _ in range(300):
            sim.step(20)
            if "somebody sends" in caplog.text:
                break
        publisher.close()
        other.close()
    assert "robot.motion: somebody sends geometry_msgs/msg/PoseStamped on /robot/cmd_vel" in caplog.text


if "rclpy" not in BACKENDS:

    @pytest.mark.timeout(300)
    def test_the_same_by_the_python_that_has_rclpy() -> None:
        """The simulation itself over rclpy; the wheels of ROS 2 need a separate Python."""
        need("rclpy", PYTHON)
        command = [PYTHON, "-m", "pytest", "-n0", "-q", "-p", "no:cacheprovider", "-k", "rclpy", __file__]
        done = subprocess.run(command, env=lent(), capture_output=True, text=True, timeout=280, check=False)
        assert done.returncode == 0, done.stdout[-4000:] + done.stderr[-2000:]
        assert " passed" in done.stdout
