"""A simulation with topics: published messages, commands, and refused input."""

import json
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from desk import Desk

import morse
from morse.core.exceptions import MorseError
from tests.kit.programs import python

typesys = pytest.importorskip("rosbags.typesys", reason="rosbags is not installed: pip install rosbags")
STORE: Any = typesys.get_typestore(typesys.Stores.ROS2_JAZZY)

SCENE = """
from morse.builder import *
robot = ATRV("{name}")
robot.translate(1.0, 2.0, 0.0)
{components}
robot.add_default_interface("ros2")
env = Environment("empty")
{options}
"""


MOTION = "motion = MotionVW(); robot.append(motion)\n"


def vector(x: float = 0.0, y: float = 0.0, z: float = 0.0, *, point: bool = False) -> Any:
    return STORE.types[f"geometry_msgs/msg/{'Point' if point else 'Vector3'}"](x=x, y=y, z=z)


def data_of(sim: Any, name: str) -> dict[str, Any]:
    data: dict[str, Any] = sim.context.components[name].local_data
    return data


def test_commands_of_velocity(start: Callable[..., tuple[Any, Desk]], caplog: pytest.LogCaptureFixture) -> None:
    sim, desk = start(MOTION)
    desk.send("/robot/cmd_vel", linear=vector(0.5), angular=vector(z=0.1))
    sim.step()
    assert (data_of(sim, "robot.motion")["v"], data_of(sim, "robot.motion")["w"]) == (0.5, 0.1)
    desk.send("/robot/motion", linear=vector(0.4, 9.0), angular=vector())
    sim.step()
    assert data_of(sim, "robot.motion")["v"] == 0.4
    for wrong in (math.nan, math.inf, 1e300):
        desk.send("/robot/cmd_vel", linear=vector(wrong), angular=vector())
        sim.step()
        assert data_of(sim, "robot.motion")["v"] == 0.4
    for garbage in (b"", b"\x00\x01\x00\x00", b"\xff" * 100, b"\x00\x01\x00\x00" + b"\xff" * 47):
        desk.send_bytes("/robot/cmd_vel", garbage)
        sim.step()
        assert data_of(sim, "robot.motion")["v"] == 0.4
    assert "robot.motion: a message on /robot/cmd_vel is refused" in caplog.text
    assert sim.context.components["robot.motion"].active


def test_odometry_is_that_of_the_robot(start: Callable[..., tuple[Any, Desk]]) -> None:
    """If a rigid body turns on the spot, a sensor 1 m off the axis moves, but the robot does not."""
    sim, desk = start(
        MOTION + "odom = Odometry(); odom.translate(1.0, 0.0, 0.3); odom.rotate(0.0, 0.0, 1.0); robot.append(odom)"
    )
    desk.send("/robot/cmd_vel", linear=vector(), angular=vector(z=0.5))
    sim.step(60)
    odometry = desk.last("/robot/odom")
    place, turn = odometry.pose.pose.position, odometry.pose.pose.orientation
    truth = sim.context.robots["robot"].position_3d
    assert (place.x, place.y) == pytest.approx((truth.x - 1.0, truth.y - 2.0), abs=1e-6)
    assert 2.0 * math.atan2(turn.z, turn.w) == pytest.approx(truth.yaw, abs=1e-6)
    assert odometry.twist.twist.angular.z == pytest.approx(0.5, abs=0.02)
    assert math.hypot(odometry.twist.twist.linear.x, odometry.twist.twist.linear.y) < 0.02
    moved = {t.child_frame_id: t for t in desk.last("/tf").transforms}["robot/base_link"].transform
    assert (moved.translation.x, moved.rotation.z) == pytest.approx((place.x, turn.z))


def test_time_goes_by_ticks_and_starts_anew(start: Callable[..., tuple[Any, Desk]]) -> None:
    sim, desk = start("pose = Pose(); robot.append(pose)")
    sim.step(61)
    now = desk.last("/clock").clock
    assert (now.sec, now.nanosec) == (1, 16_666_667)
    stamp = desk.last("/robot/pose").header.stamp
    assert (stamp.sec, stamp.nanosec) == (1, 16_666_667)
    assert desk.publishers["/clock"][1][:3] == (1, False, False)
    sim.restart()
    sim.step()
    assert desk.last("/clock").clock.sec == 0
    assert desk.last("/robot/pose").header.stamp.nanosec == 16_666_667


def test_nothing_is_encoded_for_nobody(start: Callable[..., tuple[Any, Desk]]) -> None:
    sim, desk = start("pose = Pose(); robot.append(pose)")
    for topic in ("/robot/pose", "/clock", "/tf"):
        desk.publishers[topic][2].listened = False
    sim.step(5)
    assert not any(desk.publishers[topic][2].sent for topic in ("/robot/pose", "/clock", "/tf"))
    assert desk.publishers["/tf_static"][2].sent, "who comes later gets it"


def test_cameras(start: Callable[..., tuple[Any, Desk]]) -> None:
    size = "properties(cam_width=8, cam_height=6)"
    sim, desk = start(
        f"eye = VideoCamera(); eye.{size}; eye.translate(0.3, 0.0, 0.5); robot.append(eye)\n"
        f"deep = DepthCamera(); deep.{size}; robot.append(deep)"
    )
    sim.step(10)
    image, info = desk.last("/robot/eye/image"), desk.last("/robot/eye/camera_info")
    assert image.header == info.header
    assert image.header.frame_id == "robot/eye_optical"
    assert (image.height, image.width, info.height, info.width) == (6, 8, 6, 8)
    assert desk.last("/robot/deep").header.frame_id == "robot/deep_optical"
    (turn,) = [t for t in desk.last("/tf_static").transforms if t.child_frame_id == "robot/eye_optical"]
    assert turn.header.frame_id == "robot/eye"
    q = turn.transform.rotation
    # objects in front of the camera are along Z of its image (REP 103)
    ahead = (2.0 * (q.x * q.z + q.w * q.y), 2.0 * (q.y * q.z - q.w * q.x), 1.0 - 2.0 * (q.x**2 + q.y**2))
    assert ahead == pytest.approx((1.0, 0.0, 0.0), abs=1e-12)
    right = (1.0 - 2.0 * (q.y**2 + q.z**2), 2.0 * (q.x * q.y + q.w * q.z), 2.0 * (q.x * q.z - q.w * q.y))
    assert right == pytest.approx((0.0, -1.0, 0.0), abs=1e-12)


def test_an_imu_and_its_magnetometer_have_topics_of_their_own(start: Callable[..., tuple[Any, Desk]]) -> None:
    sim, desk = start("imu = IMU(); robot.append(imu)", "env.properties(longitude=1.5, latitude=43.6, altitude=150.0)")
    sim.step(2)
    assert {topic for topic in desk.publishers if topic.startswith("/robot/imu")} == {
        "/robot/imu/data",
        "/robot/imu/mag",
    }
    assert desk.last("/robot/imu/data").header.frame_id == "robot/imu"


def test_goals_in_any_frame_of_the_robot(
    start: Callable[..., tuple[Any, Desk]], caplog: pytest.LogCaptureFixture
) -> None:
    sim, desk = start("robot.rotate(0.0, 0.0, 1.5707963)\ngoal = Waypoint(); robot.append(goal)")
    types = STORE.types

    def go(frame: str, x: float) -> tuple[float, float]:
        desk.send(
            "/robot/goal_pose",
            header=types["std_msgs/msg/Header"](stamp=types["builtin_interfaces/msg/Time"](0, 0), frame_id=frame),
            pose=types["geometry_msgs/msg/Pose"](
                position=vector(x, point=True), orientation=types["geometry_msgs/msg/Quaternion"](0.0, 0.0, 0.0, 1.0)
            ),
        )
        sim.step()
        data = data_of(sim, "robot.goal")
        return data["x"], data["y"]

    # the robot starts in (1, 2) and looks along Y
    assert go("map", 7.0) == pytest.approx((7.0, 0.0), abs=1e-6)
    assert go("", 8.0) == pytest.approx((8.0, 0.0), abs=1e-6)
    assert go("robot/odom", 3.0) == pytest.approx((1.0, 5.0), abs=1e-6)
    assert go("robot/base_link", 3.0) == pytest.approx((1.0, 5.0), abs=0.1)
    before = go("map", 6.0)
    assert go("elsewhere", 5.0) == before
    assert "unknown frame 'elsewhere'" in caplog.text


def test_a_component_that_is_deleted_takes_its_topics_along(start: Callable[..., tuple[Any, Desk]]) -> None:
    sim, desk = start(MOTION + "pose = Pose(); robot.append(pose)")
    sim.step(2)
    sim.delete("robot")
    sim.step(2)
    assert desk.publishers["/robot/pose"][2].closed
    assert all(one.closed for one in desk.subscriptions["/robot/cmd_vel"][2])
    sim.close()
    assert desk.closed


def test_fields_that_no_message_has(start: Callable[..., tuple[Any, Desk]]) -> None:
    sim, desk = start(
        "velocity = Velocity(); robot.append(velocity); velocity.add_stream('ros2', fields=True)\n"
        "near = Proximity(); robot.append(near); near.add_stream('ros2', topic='/near')"
    )
    sim.step(2)
    assert desk.last("/robot/velocity").header.frame_id == "robot/velocity"
    assert len(desk.last("/robot/velocity/world_linear_velocity").data) == 3
    assert "near_objects" in json.loads(desk.last("/near").data)


def test_names_and_options(start: Callable[..., tuple[Any, Desk]]) -> None:
    _, desk = start(
        "scan = Hokuyo(); robot.append(scan)\n"
        "scan.add_stream('ros2', topic='front/scan', frame_id='laser', qos='sensor')\n"
        "motion = MotionVW(); robot.append(motion); motion.add_stream('ros2', stamped=True)",
        "env.configure_stream_manager('ros2', namespace='', frame_prefix='')",
    )
    assert desk.publishers["/front/scan"][1].reliable is False
    assert desk.subscriptions["/cmd_vel"][0] == "geometry_msgs/msg/TwistStamped"


@pytest.mark.parametrize(
    ("components", "options", "said"),
    [
        ("a = Pose(); robot.append(a); a.add_stream('ros2', topic='/x')\n"
         "b = Pose(); robot.append(b); b.add_stream('ros2', topic='/x')", "", "the topic /x is that of robot.a"),
        ("a = Odometry(); robot.append(a)\nb = Odometry(); robot.append(b)", "", "set tf=False"),
        ("a = Pose(); robot.append(a); a.add_stream('ros2', topic='a b')", "", "expected words of letters"),
        ("a = Pose(); robot.append(a); a.add_stream('ros2', topik='/a')", "", "did you mean 'topic'"),
        ("a = Pose(); robot.append(a); other = ATRV(); b = Pose(); other.append(b); b.add_stream('ros2')",
         "env.configure_stream_manager('ros2', namespace='')", "are for one robot"),
    ],
)  # fmt: skip
def test_what_does_not_fit_is_refused_by_name(
    start: Callable[..., tuple[Any, Desk]], components: str, options: str, said: str
) -> None:
    with pytest.raises(MorseError, match=said):
        start(components, options)


def test_nothing_is_imported_unless_a_scene_asks_for_it(tmp_path: Path) -> None:
    scene = tmp_path / "scene.py"
    scene.write_text(SCENE.format(components="pose = Pose(); robot.append(pose)", options="", name="robot"))
    script = (
        "import sys, morse\n"
        "from morse.middleware import registry\n"
        "registry.installed()\n"
        f"text = open({str(scene)!r}).read().replace('\"ros2\"', '\"socket\"')\n"
        f"open({str(scene)!r}, 'w').write(text)\n"
        f"with morse.load({str(scene)!r}, sockets=True) as sim: sim.step()\n"
        "print([name for name in ('rclpy', 'cyclonedds', 'morse.rosmsgs.topics.manager') if name in sys.modules])\n"
    )
    done = python("-c", script)
    assert done.stdout.splitlines()[-1:] == ["[]"], done.stderr


def test_where_nothing_is_installed_the_error_names_the_line_that_installs_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("morse.middleware.ros2.domain.find_spec", lambda name: None)
    scene = tmp_path / "scene.py"
    scene.write_text(SCENE.format(components="pose = Pose(); robot.append(pose)", options="", name="robot"))
    with pytest.raises(MorseError, match=r'scene\.py:\d+.*pip install "cyclonedds>=11,<12"'):
        morse.load(scene, sockets=True)
