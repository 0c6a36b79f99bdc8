"""The scene and the node of the documentation."""

from __future__ import annotations

import subprocess
import time
from pathlib import Path

import pytest
from other_side import DOMAIN, PYTHON, environment, need

import morse

BLOCKS = (Path(__file__).parents[3] / "docs" / "ros2.md").read_text(encoding="utf-8").split("```python\n")[1:]
LIMIT = 60.0


@pytest.mark.slow
def test_the_node_of_the_documentation_drives_the_robot(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    need("cyclonedds")
    need("rclpy", PYTHON)
    scene, client = (block.partition("```")[0] for block in BLOCKS[:2])
    monkeypatch.setenv("ROS_DOMAIN_ID", str(DOMAIN))
    monkeypatch.delenv("CYCLONEDDS_URI", raising=False)
    (tmp_path / "default.py").write_text(scene)
    (tmp_path / "client.py").write_text(client)
    variables = {**environment(PYTHON), "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST"}
    with (
        morse.load(tmp_path / "default.py", sockets=True) as sim,
        (tmp_path / "said").open("w+") as said,
        subprocess.Popen([PYTHON, str(tmp_path / "client.py")], stdout=said, stderr=said, env=variables) as node,
    ):
        end = time.monotonic() + LIMIT
        while node.poll() is None and time.monotonic() < end:
            sim.step()
            time.sleep(0.002)
        node.kill()
    text = (tmp_path / "said").read_text()
    assert node.returncode == 0, text
    assert "odometry 0.5 m" in text
