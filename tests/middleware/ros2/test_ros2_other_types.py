"""A topic has one type: the log reports senders of another type, whose messages do not arrive."""

from __future__ import annotations

from typing import TYPE_CHECKING

from other_side import DOMAIN, need

import morse
from morse.rosmsgs.qos import Qos

if TYPE_CHECKING:
    from pathlib import Path

    import pytest

SCENE = """
from morse.builder import *
robot = ATRV()
robot.append(MotionVW("motion"))
robot.add_default_interface("ros2")
env = Environment("empty", fastmode=True)
env.configure_stream_manager("ros2", domain_id={domain}, backend="cyclonedds")
"""


def test_a_stamped_velocity_for_a_topic_that_takes_none(
    tmp_path: Path, caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    need("cyclonedds")
    monkeypatch.delenv("CYCLONEDDS_URI", raising=False)
    from morse.middleware.ros2.backends.cyclone import CycloneBackend

    (tmp_path / "scene.py").write_text(SCENE.format(domain=DOMAIN))
    with morse.load(tmp_path / "scene.py", sockets=True) as sim:
        sim.step(300)
        assert "somebody sends" not in caplog.text
        other = CycloneBackend({"domain_id": DOMAIN, "interface": "lo"})
        publisher = other.publisher("/robot/cmd_vel", "geometry_msgs/msg/TwistStamped", Qos())
        for _ in range(300):
            sim.step(20)
            if "somebody sends" in caplog.text:
                break
        publisher.close()
        other.close()
    assert "robot.motion: somebody sends geometry_msgs/msg/TwistStamped on /robot/cmd_vel" in caplog.text
    assert "set stamped=True" in caplog.text
