"""ROS 1, with a real master and a real node of rospy in another process."""

import json
import logging
import math
import socket
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from master import environment, master, need_ros, run, simulation

import morse
from morse.core.exceptions import MorseError, MorseMiddlewareError
from morse.core.mathutils import Quaternion
from morse.plugins.ros.mapping import MIDDLEWARE
from morse.plugins.ros.node import stay_on_this_machine
from morse.plugins.ros.overlays import action_type
from morse.plugins.ros.variants import as_lisp, class_path
from tests.kit.programs import free_port

HERE = Path(__file__).parent
SCENE = """
from morse.builder import *
robot = ATRV()
robot.append(MotionVW("motion"))
robot.append(Pose("pose"))
robot.append(Odometry("odometry"))
scan = Hokuyo("scan"); scan.translate(0.2, 0.0, 0.6); robot.append(scan)
robot.append(IMU("imu"))
robot.append(Proximity("near"))
eye = VideoCamera("eye"); eye.properties(cam_width=32, cam_height=24); robot.append(eye)
ptu = PTU("ptu"); robot.append(ptu); ptu.append(PTUPosture("posture"))
robot.add_default_interface("ros")
other = ATRV(); other.translate(0.0, 8.0, 0.0)
other.append(Teleport("jump"))
other.append(Pose("pose"))
truth = Pose("truth"); other.append(truth)
truth.add_stream("ros", "morse.middleware.ros.pose.TFPublisher", frame_id="/world", child_frame_id="/other")
bare = Pose("bare"); other.append(bare)
bare.add_stream("ros", "morse.middleware.ros.pose.PosePublisher", topic="/where")
mast = Gyroscope("mast"); mast.translate(0.1, 0.2, 1.0); other.append(mast)
mast.add_stream("ros", method="morse.middleware.ros.static_tf.StaticTF2Publisher", frame_id="/mast")
fan = Sick("fan"); fan.translate(0.0, 0.0, 0.3); fan.rotate(y=0.4); other.append(fan)
fan.add_stream("ros", classpath="morse.middleware.ros.laserscanner.PointCloud2Publisher")
pull = Accelerometer("pull"); other.append(pull)
pull.add_stream("ros", method="TwistPublisher", path="morse.middleware.ros.accelerometer")
look = SemanticCamera("look"); look.properties(cam_width=32, cam_height=32, tag="Robot_Tag"); look.rotate(x=-1.57)
other.append(look)
lens = VideoCamera("lens"); lens.properties(cam_width=32, cam_height=24); other.append(lens)
lens.add_stream("ros", topic_suffix="/image_raw")
dist = Odometry("odom"); other.append(dist)
dist.add_stream("ros", "morse.middleware.ros.odometry.OdometryPublisher")
other.add_default_interface("ros")
env = Environment("empty")
env.add_service("ros")
"""
RATE = 60.0


@pytest.fixture(scope="module")
def uri() -> Iterator[str]:
    need_ros()
    with master() as address:
        yield address


@pytest.fixture(scope="module")
def said(uri: str, tmp_path_factory: pytest.TempPathFactory) -> Any:
    scene = tmp_path_factory.mktemp("ros1") / "scene.py"
    scene.write_text(SCENE)
    with simulation(scene, uri):
        return json.loads(run(HERE / "ros1_peer.py", uri))


@pytest.mark.peer("python3-rospy")
def test_a_node_drives_the_robot_and_sees_what_it_does(said: Any) -> None:
    assert said["missing"] == []
    assert said["x"] > 0.3
    assert said["speed"] == pytest.approx(0.5, abs=0.02)
    assert said["gravity"] == pytest.approx(9.81, abs=0.5)
    assert said["joints"][0] == ["pan", "tilt"]
    # in a Vector3, y is pan and z is tilt
    assert said["joints"][1] == pytest.approx([0.4, -0.2], abs=0.06)
    assert "other" in said["near"], "the other robot has jumped there"


@pytest.mark.peer("python3-rospy")
def test_the_log_of_the_simulation_is_a_topic(said: Any) -> None:
    level, name, text = said["log"]
    assert level == 4  # rosgraph_msgs/Log.WARN
    assert name.startswith("morse.")
    assert text.startswith("robot.motion: ")


@pytest.mark.peer("python3-rospy")
def test_stamps_are_simulated_time(said: Any) -> None:
    ticks = [stamp * 1e-9 * RATE for stamp in said["stamps"]]
    assert ticks == sorted(ticks)
    assert all(abs(tick - round(tick)) < 1e-6 for tick in ticks)
    assert ticks[-1] < 60.0 * RATE * 60.0


def test_names_of_frames_are_those_of_1_4(said: Any) -> None:
    frames = said["frames"]
    assert frames["/robot/pose"] == "/map"
    assert (frames["/robot/odometry"], said["child"]) == ("/odom", "/base_footprint")
    assert frames["/robot/scan"] == "/base_laser_link"
    assert frames["/robot/imu"] == "/imu"
    assert frames["/robot/eye/image"] == frames["/robot/eye/camera_info"] == "/robot/eye"
    assert ["/odom", "/base_footprint"] in said["tf"]
    assert ["/base_link", "/robot/eye"] in said["tf"]


def test_streams_with_the_class_names_of_1_4(said: Any) -> None:
    # 1.4 chose other messages by the class of the stream
    assert said["where"] == pytest.approx([7.0, 8.0, 1.0], abs=1e-3)
    assert said["world to other"] == pytest.approx([7.0, 8.0, 1.0], abs=1e-3)
    assert said["mast"] == ["base_link", [pytest.approx(0.1), pytest.approx(0.2), pytest.approx(1.0)]]
    assert said["pull"] == pytest.approx([0.0, 0.0, 0.0], abs=1e-3)
    assert "/other/lens/image_raw" not in said["missing"]


def test_points_of_a_scanner_are_those_that_it_hits(said: Any) -> None:
    # a fan that is tilted down meets the ground at height 0, from 1.3 m
    x, _, _ = said["points"][len(said["points"]) // 2]
    assert x == pytest.approx(1.3 / math.sin(0.4), rel=1e-3)
    assert len(said["points"]) < 181


def test_recognised_objects_have_frames(said: Any) -> None:
    assert "robot" in said["recognised"]


@pytest.mark.peer("python3-rospy")
def test_messages_keep_their_definitions(said: Any) -> None:
    count, first, last, step, nearest = said["scan"]
    assert last == pytest.approx(first + (count - 1) * step, abs=1e-4)
    assert first == pytest.approx(-math.radians(135.0), abs=1e-4)
    assert nearest == pytest.approx(0.3)
    assert said["image"] == ["rgba8", 32, 24, 128, 32 * 24 * 4]
    focal, width, distortion, model = said["info"]
    assert (width, distortion, model) == (32, [0.0] * 5, "plumb_bob")
    assert focal > 0.0
    assert said["robots"] == [True, '["robot","other"]']


def test_without_a_master_the_error_says_what_to_start(tmp_path: Path) -> None:
    need_ros()
    scene = tmp_path / "scene.py"
    scene.write_text(SCENE)
    done = subprocess.run(
        [sys.executable, "-m", "morse", "run", "--headless", str(scene)],
        env=environment("http://127.0.0.1:9/"), capture_output=True, text=True, timeout=100, check=False,
    )  # fmt: skip
    assert done.returncode == 1
    assert "there is no master at http://127.0.0.1:9/" in done.stdout
    assert "roscore" in done.stdout
    assert "Traceback" not in done.stdout + done.stderr


def test_where_rospy_is_missing_the_error_says_what_to_install(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "rospy", None)  # as if it could not be imported
    scene = tmp_path / "scene.py"
    scene.write_text(SCENE)
    with pytest.raises(MorseError, match="sudo apt install python3-rospy"):
        morse.load(scene, sockets=True)


# -- a master that is started again knows the topics of a running simulation -----------------------


def test_a_new_master_knows_the_topics() -> None:
    need_ros()
    port = free_port()
    with master(port) as uri:
        peer = subprocess.Popen(
            [sys.executable, str(Path(__file__).with_name("node_peer.py"))],
            env=environment(uri), stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
        )  # fmt: skip
        assert peer.stdout is not None
        assert peer.stdout.readline() == "ready\n"
    with peer, master(port):
        try:
            out, log = peer.communicate("go\n", timeout=100.0)
        finally:
            peer.kill()
    assert out == "True True\n", log
    assert "was started again" in log


# -- on which networks the node of rospy listens; rospy itself need not be installed ---------------


@pytest.mark.parametrize(
    "master",
    [
        None,
        "http://localhost:11311",
        "http://127.0.0.1:11311/",
        "http://[::1]:11311",
        f"http://{socket.gethostname()}:1",
    ],
)
def test_a_node_of_a_local_master_listens_on_the_loopback_interface(master: str | None) -> None:
    variables = {} if master is None else {"ROS_MASTER_URI": master}
    stay_on_this_machine(variables)
    assert variables["ROS_IP"] == "127.0.0.1"


@pytest.mark.parametrize("name", ["ROS_IP", "ROS_HOSTNAME"])
def test_an_address_that_the_user_has_chosen_stays(name: str) -> None:
    variables = {name: "192.0.2.7"}
    stay_on_this_machine(variables)
    assert variables == {name: "192.0.2.7"}


def test_a_remote_master_is_a_warning(caplog: pytest.LogCaptureFixture) -> None:
    caplog.set_level(logging.WARNING)
    variables = {"ROS_MASTER_URI": "http://192.0.2.1:11311"}
    stay_on_this_machine(variables)
    assert "ROS_IP" not in variables
    assert "192.0.2.1" in caplog.text


# -- class paths of ROS 1 that need no master ------------------------------------------------------


@pytest.mark.parametrize(
    ("given", "used"),
    [
        ("morse.middleware.ros.pose.TFPublisher", "morse.plugins.ros.variants.TFPublisher"),
        ("morse.middleware.ros.waypoint2D.Pose2DReader", "morse.plugins.ros.variants.Pose2DReader"),
        ("morse.middleware.ros.imu.ImuPublisher", MIDDLEWARE.default_publisher),
        ("my_lab.streams.TFPublisher", "my_lab.streams.TFPublisher"),
    ],
)
def test_streams_have_the_class_paths_of_1_4(given, used):
    assert class_path(given, "robot.pose") == used


def test_an_unknown_class_is_reported(caplog):
    assert class_path("morse.middleware.ros.pose.Posse", "robot.pose") == MIDDLEWARE.default_publisher
    assert "there is no class morse.middleware.ros.pose.Posse: robot.pose uses its usual messages" in caplog.text


def test_a_missing_package_of_messages_is_named():
    with pytest.raises(MorseMiddlewareError, match="sudo apt install ros-noetic-no-such-msgs"):
        action_type("AnyAction", "no_such_msgs")


# -- recognised objects in the format of Lisp ------------------------------------------------------


def _seen(name, description="", position=(1.0, 2.0, 0.5)):
    return {
        "name": name,
        "description": description,
        "type": "",
        "position": list(position),
        "orientation": Quaternion((0.5, -0.5, 0.5, -0.5)),
    }


def test_the_class_path_of_1_4_is_known():
    path = class_path("morse.middleware.ros.semantic_camera.SemanticCameraPublisherLisp", "robot.camera")
    assert path == "morse.plugins.ros.variants.SemanticCameraPublisherLisp"


def test_an_object_is_a_list_of_name_description_position_and_quaternion():
    assert as_lisp([_seen("RedBox", "crate")]) == "((RedBox crate 1.0 2.0 0.5 -0.5 0.5 -0.5 0.5))"


def test_an_object_without_a_description_and_an_empty_list():
    assert as_lisp([_seen("RedBox"), _seen("B")]).count(" - ") == 2
    assert as_lisp([]) == "()"


@pytest.mark.parametrize(
    ("name", "atom"),
    [
        ("Red Box", '"Red Box"'),
        ('a "b" (c)', '"a \\"b\\" (c)"'),
        ("back\\slash", '"back\\\\slash"'),
        ("12", '"12"'),
        ("Box.001", "Box.001"),
    ],
)
def test_names_that_are_no_symbols_are_quoted(name, atom):
    assert as_lisp([_seen(name)]).startswith(f"(({atom} - ")


# -- what nodes written for MORSE 1.4 expect on ROS 1: joints of a PR2, ranges, the action server --

ROS1_FACTS_SCENE = """
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
    scene.write_text(ROS1_FACTS_SCENE)
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
