"""The scene and the node of the documentation."""

import subprocess
import time
from pathlib import Path

import pytest
from desk import Desk
from other_side import DOMAIN, PYTHON, environment, need

import morse

BLOCKS = (Path(__file__).parents[3] / "docs" / "ros2.md").read_text(encoding="utf-8").split("```python\n")[1:]
LIMIT = 60.0


@pytest.mark.slow
@pytest.mark.peer("ros-jazzy-rclpy")
def test_the_node_of_the_documentation_drives_the_robot(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    need("cyclonedds")
    need("rclpy", PYTHON)
    scene, client = (block.partition("```")[0] for block in BLOCKS[:2])
    monkeypatch.setenv("ROS_DOMAIN_ID", str(DOMAIN))
    monkeypatch.delenv("CYCLONEDDS_URI", raising=False)
    (tmp_path / "default.py").write_text(scene)
    (tmp_path / "client.py").write_text(client)
    with (
        morse.load(tmp_path / "default.py", sockets=True) as sim,
        (tmp_path / "said").open("w+") as said,
        subprocess.Popen(
            [PYTHON, str(tmp_path / "client.py")], stdout=said, stderr=said, env=environment(PYTHON)
        ) as node,
    ):
        end = time.monotonic() + LIMIT
        while node.poll() is None and time.monotonic() < end:
            sim.step()
            time.sleep(0.002)
        node.kill()
    text = (tmp_path / "said").read_text()
    assert node.returncode == 0, text
    assert "odometry 0.5 m" in text


def test_the_scene_for_navigation_has_the_names_that_stacks_expect(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    typesys = pytest.importorskip("rosbags.typesys", reason="rosbags is not installed: pip install rosbags")
    desk = Desk(typesys.get_typestore(typesys.Stores.ROS2_JAZZY))
    monkeypatch.setattr("morse.middleware.ros2.domain.make_backend", lambda options: desk)
    (tmp_path / "default.py").write_text(next(b for b in BLOCKS if "Pioneer3DX" in b).partition("```")[0])
    with morse.load(tmp_path / "default.py", sockets=True) as sim:
        sim.step(12)
        assert desk.subscriptions["/cmd_vel"][0] == "geometry_msgs/msg/Twist"
        scan, odometry = desk.last("/scan"), desk.last("/odom")
        assert scan.header.frame_id == "scan"
        assert (odometry.header.frame_id, odometry.child_frame_id) == ("odom", "base_link")
        parents = {
            t.child_frame_id: t.header.frame_id for topic in ("/tf", "/tf_static") for t in desk.last(topic).transforms
        }
        # the transforms from the scan to odom; the stack publishes that from map to odom
        assert parents["scan"] == "base_link"
        assert parents["base_link"] == "odom"
        assert "odom" not in parents
        assert any(0.2 < distance < 30.0 for distance in scan.ranges), "walls"
