"""What nodes written for MORSE 1.4 expect on ROS 1: joints of a PR2, ranges, the action server."""

from __future__ import annotations

import json
from pathlib import Path

from master import master, need_ros, run, simulation

SCENE = """
from morse.builder import *
robot = ATRV()
scan = Hokuyo("scan"); scan.translate(z=1.0); robot.append(scan); scan.add_stream("ros")
waypoint = Waypoint(); robot.append(waypoint)
waypoint.add_overlay("ros", "morse.middleware.ros.overlays.waypoints.WayPoint")
pr2 = BasePR2(); pr2.translate(x=-5); pr2.add_interface("ros")
env = Environment("empty", fastmode=True)
env.add_service("ros")
"""


def test_joints_ranges_and_actions(tmp_path: Path) -> None:
    need_ros()
    scene = tmp_path / "scene.py"
    scene.write_text(SCENE)
    with master() as uri, simulation(scene, uri):
        said = json.loads(run(Path(__file__).parent / "facts_peer.py", uri))
    assert said["answers"]
    # a torso, a head of two joints and two arms of seven
    assert len(set(said["names"])) == said["positions"] == 1 + 2 + 7 + 7
    assert {"torso_lift_joint", "head_pan_joint", "l_wrist_roll_joint", "r_wrist_roll_joint"} <= set(said["names"])
    assert said["scan"] == [30.0, 30.0, 30.0]
    assert said["tf"] == "tf2_msgs/TFMessage"
