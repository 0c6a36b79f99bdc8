"""What nodes written for MORSE 1.4 expect on ROS 1: joints of a PR2, ranges, the action server."""

import json
from pathlib import Path

import pytest
from master import master, need_ros, run, simulation

SCENE = """
from morse.builder import *
robot = ATRV()
scan = Hokuyo("scan"); scan.translate(z=1.0); robot.append(scan); scan.add_stream("ros")
waypoint = Waypoint(); robot.append(waypoint)
waypoint.add_overlay("ros", "morse.middleware.ros.overlays.waypoints.WayPoint")
pr2 = BasePR2(); pr2.translate(x=-5); pr2.add_interface("ros")
place = Pose("place"); place.translate(0.1, 0.2, 0.3); robot.append(place)
place.add_stream("ros", "morse.middleware.ros.static_tf.StaticTFPublisher")
mast = Pose("mast"); mast.translate(z=1.0); robot.append(mast)
mast.add_stream("ros", "morse.middleware.ros.static_tf.StaticTF2Publisher")
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
    # the joints of casters, grippers, the tilting laser and the screw of the torso are not measured
    assert len(set(said["names"])) == len(said["positions"]) == 45
    positions = dict(zip(said["names"], said["positions"], strict=True))
    names = ("fl_caster_rotation_joint", "laser_tilt_mount_joint", "torso_lift_motor_screw_joint", "l_gripper_joint")
    assert [positions[name] for name in names] == [0.0] * 4
    assert {"head_pan_joint", "l_wrist_roll_joint", "r_wrist_roll_joint"} <= set(said["names"])
    assert said["scan"] == [30.0, 30.0, 30.0]
    assert said["tf"] == "tf2_msgs/TFMessage"
    assert said["mast"] == [["base_link", "/robot/mast", pytest.approx([0.0, 0.0, 1.0])]]
    first, second = said["place"]
    assert first[:2] == ["base_link", "/robot/place"]
    assert first[2] == pytest.approx([0.1, 0.2, 0.3])
    assert second[3] - first[3] == pytest.approx(1.0, abs=1e-6)
    assert said["ahead"] == pytest.approx(1.0, abs=0.5)
