"""Whole robots: their description, joints, frames, detections and log."""

import io
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest
from desk import Desk
from PIL import Image
from test_base_frames import JOINT, LAYOUTS, LINK

from morse.actuators.ackermann import MotionVWAckermann
from morse.rosmsgs import cdr
from morse.rosmsgs.cdr import decode
from morse.rosmsgs.kinds import Ros2Topics

Start = Callable[..., tuple[Any, Desk]]

WHEELS = """
robot = Pioneer3DX("rover")
robot.append(MotionVWDiff("motion"))
robot.append(WheelEncoders("wheels"))
ptu = PTU("ptu"); ptu.translate(0.1, 0.0, 0.3); robot.append(ptu)
ptu.append(PTUPosture("posture"))
robot.add_default_interface("ros2")
"""


def rotation(q: Any) -> Any:
    """(3, 3) from a quaternion of ROS."""
    x, y, z, w = q.x, q.y, q.z, q.w
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def from_rpy(text: str) -> Any:
    """(3, 3) from roll, pitch, yaw about fixed axes, as in URDF."""
    (a, b, c) = (float(word) for word in text.split())
    x = np.array([[1, 0, 0], [0, math.cos(a), -math.sin(a)], [0, math.sin(a), math.cos(a)]])
    y = np.array([[math.cos(b), 0, math.sin(b)], [0, 1, 0], [-math.sin(b), 0, math.cos(b)]])
    z = np.array([[math.cos(c), -math.sin(c), 0], [math.sin(c), math.cos(c), 0], [0, 0, 1]])
    return z @ y @ x


def about(axis: Any, angle: float) -> Any:
    """(3, 3) by Rodrigues' formula."""
    x, y, z = axis
    k = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + math.sin(angle) * k + (1 - math.cos(angle)) * (k @ k)


def numbers(text: str) -> Any:
    return np.array([float(word) for word in text.split()])


def frames(desk: Desk, *topics: str) -> dict[str, Any]:
    return {t.child_frame_id: t for topic in topics for t in desk.last(topic).transforms}


def test_the_joints_of_the_description_move_as_tf_and_joint_states_say(start: Start) -> None:
    sim, desk = start(WHEELS)
    twist = desk.store.types["geometry_msgs/msg/Twist"]
    vector = desk.store.types["geometry_msgs/msg/Vector3"]
    head = desk.store.types["std_msgs/msg/Header"](desk.store.types["builtin_interfaces/msg/Time"](0, 0), "")
    assert twist
    desk.send("/rover/cmd_vel", linear=vector(0.4, 0.0, 0.0), angular=vector(0.0, 0.0, 0.3))
    nothing = np.zeros(0)
    desk.send("/rover/ptu", header=head, name=["pan", "tilt"], position=np.array([0.5, -0.3]), velocity=nothing,
              effort=nothing)  # fmt: skip
    sim.step(90)
    model = ElementTree.fromstring(desk.last("/rover/robot_description").data)
    states = desk.last("/rover/joint_states")
    positions = dict(zip(states.name, states.position, strict=True))
    joints = {joint.get("name"): joint for joint in model.iter("joint")}
    assert set(positions) <= set(joints)
    assert positions["pan"] == pytest.approx(0.5, abs=0.01)
    assert positions["tilt"] == pytest.approx(-0.3, abs=0.01)
    assert positions["Wheel_R"] > positions["Wheel_L"] > 2.0, "it drives on and turns to the left"
    moving = frames(desk, "/tf")
    for name, position in positions.items():
        joint = joints[name]
        origin, axis = joint.find("origin"), joint.find("axis")
        link = joint.find("child").get("link")
        expected = from_rpy(origin.get("rpy")) @ about(numbers(axis.get("xyz")), position)
        # encoders count whole steps
        np.testing.assert_allclose(rotation(moving[link].transform.rotation), expected, atol=3e-3)
        place = moving[link].transform.translation
        np.testing.assert_allclose([place.x, place.y, place.z], numbers(origin.get("xyz")), atol=1e-6)
        assert moving[link].header.frame_id == joint.find("parent").get("link")
    wheel = joints["Wheel_L"]
    forward = from_rpy(wheel.find("origin").get("rpy")) @ numbers(wheel.find("axis").get("xyz"))
    np.testing.assert_allclose(forward, [0.0, 1.0, 0.0], atol=1e-6, err_msg="wheels that drive forward turn about Y")


def test_what_a_joint_does_not_measure_is_nan(start: Start) -> None:
    sim, desk = start(WHEELS)
    sim.step(3)
    states = desk.last("/rover/joint_states")
    assert len(states.position) == len(states.velocity) == len(states.name)
    velocity = dict(zip(states.name, states.velocity, strict=True))
    assert math.isnan(velocity["pan"])
    assert math.isfinite(velocity["Wheel_L"])
    assert len(states.effort) == 0


def test_the_description_is_one_tree_of_the_frames_in_tf(start: Start) -> None:
    sim, desk = start(WHEELS + "robot.append(VideoCamera('eye')); ptu.append(Hokuyo('scan'))\n")
    sim.step(2)
    model = ElementTree.fromstring(desk.last("/rover/robot_description").data)
    links = [link.get("name") for link in model.iter("link")]
    assert len(links) == len(set(links))
    names = [joint.get("name") for joint in model.iter("joint")]
    assert len(names) == len(set(names))
    parents = {joint.find("child").get("link"): joint.find("parent").get("link") for joint in model.iter("joint")}
    assert set(links) - parents.keys() == {"rover/base_link"}
    assert set(parents.values()) <= set(links)
    known = frames(desk, "/tf", "/tf_static")
    assert set(parents) <= known.keys()
    for frame, parent in parents.items():
        assert known[frame].header.frame_id == parent
    body = next(link for link in model.iter("link") if link.get("name") == "rover/base_link")
    sizes = [numbers(box.get("size")) for box in body.iter("box")]
    # the Pioneer 3-DX is 455 mm long and 381 mm wide (its data sheet), with its wheels
    assert max(size[0] for size in sizes) == pytest.approx(0.455, abs=0.03)


def test_two_heads_of_one_robot_have_joints_of_their_own(start: Start) -> None:
    sim, desk = start(
        WHEELS.replace('robot.add_default', 'other = PTU("other"); robot.append(other)\n'
                       'other.append(PTUPosture("posture"))\nrobot.add_default')
    )  # fmt: skip
    sim.step(2)
    names = list(desk.last("/rover/joint_states").name)
    assert sorted(names) == ["Wheel_L", "Wheel_R", "other/pan", "other/tilt", "ptu/pan", "ptu/tilt"]
    model = ElementTree.fromstring(desk.last("/rover/robot_description").data)
    assert set(names) <= {joint.get("name") for joint in model.iter("joint")}


def test_what_a_camera_looks_at_is_along_z_of_its_optical_frame(start: Start) -> None:
    sim, desk = start(
        "eye = VideoCamera('eye'); eye.properties(cam_width=8, cam_height=6); eye.translate(0.3, 0.0, 0.5)\n"
        "eye.rotate(0.0, 0.4, 0.7); robot.append(eye)"
    )
    sim.step(2)
    fixed = frames(desk, "/tf_static")
    own, optical = (rotation(fixed[f"robot/eye{name}"].transform.rotation) for name in ("", "_optical"))
    # the image is captured along Z of the object, X right and Y down (morse.sensors.camera)
    picture = np.reshape(sim.context.components["robot.eye"].bge_object.world_pose()[1], (3, 3))
    forward = picture[:, 2]
    np.testing.assert_allclose(own[:, 0], forward, atol=1e-4)
    np.testing.assert_allclose((own @ optical)[:, 2], forward, atol=1e-4)
    np.testing.assert_allclose(own @ optical, picture, atol=1e-4)


def test_an_altimeter_looks_down_however_the_robot_leans(start: Start) -> None:
    sim, desk = start(
        "robot = Quadrotor('flyer'); robot.translate(0.0, 0.0, 5.0); robot.rotate(0.5, 0.2, 1.0)\n"
        "robot.append(RadarAltimeter('height')); robot.add_default_interface('ros2')"
    )
    sim.step(1)
    message = desk.last("/flyer/height")
    assert message.header.frame_id == "flyer/height_down"
    known = frames(desk, "/tf", "/tf_static")
    chain = [known[frame] for frame in ("flyer/odom", "flyer/base_link", "flyer/height_down")]
    assert [t.header.frame_id for t in chain] == ["map", "flyer/odom", "flyer/base_link"]
    world = rotation(chain[0].transform.rotation) @ rotation(chain[1].transform.rotation)
    world = world @ rotation(chain[2].transform.rotation)
    np.testing.assert_allclose(world[:, 0], [0.0, 0.0, -1.0], atol=1e-6)


SEES = """
crate = PassiveObject('props/objects', 'SmallTable'); crate.translate(3.5, 2.0, 0.5)
crate.setgraspable(); crate.properties(Object=True, Label='crate', Type='Box')
eye = SemanticCamera('eye'); eye.translate(0.3, 0.0, 0.7); robot.append(eye)
"""


def test_things_that_are_seen(start: Start) -> None:
    sim, desk = start(SEES)
    sim.step(10)
    kind, _, publisher = desk.publishers["/robot/eye"]
    assert kind == "vision_msgs/msg/Detection3DArray"
    message = decode(kind, publisher.sent[-1])
    assert message["header"]["frame_id"] == "map"
    (seen,) = message["detections"]
    assert (seen["id"], seen["results"][0]["hypothesis"]["class_id"]) == ("crate", "Box")
    place = seen["bbox"]["center"]["position"]
    assert (place["x"], place["y"]) == pytest.approx((3.5, 2.0), abs=0.05)
    markers = desk.last("/robot/eye/markers").markers
    assert markers[0].action == markers[0].DELETEALL
    assert [marker.text for marker in markers if marker.type == marker.TEXT_VIEW_FACING] == ["crate"]


def test_a_backend_without_vision_msgs_carries_json(start: Start, monkeypatch: pytest.MonkeyPatch) -> None:
    made = Desk.publisher
    monkeypatch.setattr(
        Desk, "publisher",
        lambda self, topic, name, qos: None if name.startswith("vi") else made(self, topic, name, qos),
    )  # fmt: skip
    sim, desk = start(SEES)
    sim.step(10)
    assert '"crate"' in desk.last("/robot/eye").data
    assert "/robot/eye/markers" not in desk.publishers


def test_images_as_jpeg(start: Start) -> None:
    sim, desk = start("eye = VideoCamera('eye'); eye.properties(cam_width=40, cam_height=30); robot.append(eye)")
    sim.step(4)
    message = desk.last("/robot/eye/image/compressed")
    picture = Image.open(io.BytesIO(message.data.tobytes()))
    assert (picture.format, picture.size) == ("JPEG", (40, 30))
    raw = desk.last("/robot/eye/image")
    original = raw.data.reshape(30, 40, 4)[..., :3].astype(float)
    assert np.abs(np.asarray(picture, dtype=float) - original).mean() < 8.0


def test_the_log_is_a_topic(start: Start) -> None:
    sim, desk = start("motion = MotionVW(); robot.append(motion)")
    desk.send_bytes("/robot/cmd_vel", b"garbage")
    sim.step(2)
    _, qos, publisher = desk.publishers["/rosout"]
    assert qos.latched
    lines = [desk.store.deserialize_cdr(data, "rcl_interfaces/msg/Log") for data in publisher.sent]
    (line,) = [line for line in lines if "a message on /robot/cmd_vel is refused" in line.msg]
    assert line.level == 30
    assert line.name.startswith("morse.")
    sim.close()
    assert publisher.closed


@pytest.mark.parametrize("option", ["rosout", "description"])
def test_what_can_be_left_out(start: Start, option: str) -> None:
    sim, desk = start("robot.append(Pose('pose'))", f"env.configure_stream_manager('ros2', {option}=False)")
    sim.step(2)
    assert not [topic for topic in desk.publishers if option in topic]


@pytest.mark.parametrize("name", ["odom", "base_link", "map"])
def test_a_sensor_with_the_name_of_a_frame_makes_no_second_parent(start: Start, name: str) -> None:
    sim, desk = start(f"robot.append(Odometry('{name}'))")
    sim.step(2)
    transforms = [t for topic in ("/tf", "/tf_static") for t in desk.last(topic).transforms]
    children = [t.child_frame_id for t in transforms]
    assert sorted(children) == sorted(set(children))
    assert {t.child_frame_id: t.header.frame_id for t in transforms} == {
        "robot/odom": "map",
        "robot/base_link": "robot/odom",
        f"robot/{name}_link": "robot/base_link",
    }


# -- ``robot_description`` of a robot from a URDF file is this file --------------------------------

WHEEL = """<joint name="spin" type="continuous"><parent link="base_link"/><child link="wheel"/><axis xyz="0 1 0"/>
<limit effort="7" velocity="9"/></joint>"""
MESHES = """<visual><geometry><mesh filename="part.stl"/></geometry></visual>
<visual><geometry><mesh filename="package://gone/part.stl"/></geometry></visual>"""
#: options of the stream manager, the prefix of frames, and the namespace
OPTIONS = {
    "every name": ("", "rover/", "/rover"),
    "one robot": ("env.configure_stream_manager('ros2', namespace='', frame_prefix='')", "", ""),
}


def scene(file: Path) -> str:
    return f"""rover = Robot({str(file)!r})
rover.translate(x=9.0)
pose = Pose()
rover.append(pose, "base_link")
rover.add_default_interface("ros2")
"""


def tree(model: ElementTree.Element) -> dict[str, str]:
    """Link to its parent; there is one without."""
    links = [link.get("name") for link in model.findall("link")]
    assert len(links) == len(set(links))
    parents = {joint.find("child").get("link"): joint.find("parent").get("link") for joint in model.findall("joint")}
    assert len(parents) == len(model.findall("joint"))
    assert len(set(links) - set(parents)) == 1
    assert set(parents.values()) <= set(links)
    return parents


@pytest.mark.parametrize("layout", LAYOUTS)
def test_it_is_a_tree(start: Callable, tmp_path: Path, layout: str) -> None:
    links = list(dict.fromkeys(link for one in LAYOUTS[layout] for link in one[:2]))
    text = "".join([*(LINK.format(link) for link in links), *(JOINT.format(*one) for one in LAYOUTS[layout])])
    (tmp_path / "rover.urdf").write_text(f'<robot name="rover">{text}</robot>')
    sim, desk = start(scene(tmp_path / "rover.urdf"))
    sim.step(3)
    parents = tree(ElementTree.fromstring(desk.last("/rover/robot_description").data))
    assert {f"rover/{link}" for link in links} <= {*parents, *parents.values()}
    assert "rover/pose" in parents


@pytest.mark.parametrize("options", OPTIONS)
def test_it_is_the_file_of_the_user(start: Callable, tmp_path: Path, options: str) -> None:
    manager, prefix, space = OPTIONS[options]
    (tmp_path / "part.stl").write_text("solid part\nendsolid part\n")
    link = LINK.format("base_link").replace("</link>", f"{MESHES}</link>")
    extra = '<gazebo reference="base_link"><mu1>0.3</mu1></gazebo><transmission name="t"/>'
    (tmp_path / "rover.urdf").write_text(f'<robot name="rover">{link}{LINK.format("wheel")}{WHEEL}{extra}</robot>')
    sim, desk = start(scene(tmp_path / "rover.urdf"), manager)
    sim.step(3)
    model = ElementTree.fromstring(desk.last(f"{space}/robot_description").data)
    assert model.get("name") == "rover"
    (spin,) = (joint for joint in model.findall("joint") if joint.get("name") == "spin")
    assert spin.get("type") == "continuous"
    assert spin.find("limit").attrib == {"effort": "7", "velocity": "9"}
    assert spin.find("child").get("link") == f"{prefix}wheel"
    assert [mesh.get("filename") for mesh in model.iter("mesh")] == [
        (tmp_path / "part.stl").as_uri(),
        "package://gone/part.stl",
    ]
    assert model.find("transmission") is not None
    assert model.find("gazebo").get("reference") == f"{prefix}base_link"
    assert tree(model)[f"{prefix}pose"] == f"{prefix}base_link"


# -- commands of the controllers of ros2_control and of planners for cars --------------------------

JOINTS = [f"kuka_{number}" for number in range(1, 8)]
ARM = "arm = KukaLWR('arm'); robot.append(arm); pose = ArmaturePose('pose'); arm.append(pose)"
ANGLES = [0.1, -0.2, 0.3, -0.4, 0.5, 0.2, -0.1]


def measured(desk: Any) -> dict[str, float]:
    state = desk.last("/robot/joint_states")
    return {name.rpartition("/")[2]: angle for name, angle in zip(state.name, state.position, strict=True)}


@pytest.mark.parametrize("topic", ["commands", "joint_trajectory"])
def test_an_arm_takes_the_commands_of_controllers(start: Callable[..., Any], topic: str) -> None:
    sim, desk = start(ARM)
    messages = {
        "commands": ("std_msgs/msg/Float64MultiArray", {"data": ANGLES}),
        "joint_trajectory": (
            "trajectory_msgs/msg/JointTrajectory",
            {"joint_names": JOINTS[::-1], "points": [{"positions": ANGLES[::-1]}]},
        ),
    }
    kind, message = messages[topic]
    assert desk.subscriptions[f"/robot/arm/{topic}"][0] == kind
    desk.send_bytes(f"/robot/arm/{topic}", cdr.encode(kind, message))
    sim.step(120)
    assert [measured(desk)[joint] for joint in JOINTS] == pytest.approx(ANGLES, abs=0.01)


def test_the_topics_of_topic_based_ros2_control(start: Callable[..., Any]) -> None:
    """Its default topics; joints without a command are NaN until their controller is active."""
    topics = (
        "arm.add_stream('ros2', topic='/robot_joint_command')\npose.add_stream('ros2', topic='/robot_joint_states')"
    )
    sim, desk = start(f"{ARM}\n{topics}")
    kind = "sensor_msgs/msg/JointState"
    assert desk.subscriptions["/robot_joint_command"][0] == kind
    for angles in ([math.nan] * 7, [0.3, *[math.nan] * 6], ANGLES[:2] + [math.nan] * 5):
        desk.send_bytes("/robot_joint_command", cdr.encode(kind, {"name": JOINTS, "position": angles}))
        sim.step(120)
        measured_state = desk.last("/robot_joint_states")
        assert list(measured_state.name) == JOINTS, "as in the URDF file"
        expected = [0.0 if math.isnan(angle) else angle for angle in angles]
        assert list(measured_state.position) == pytest.approx(expected, abs=0.01)


def test_joints_whose_motors_control_different_quantities(start: Callable[..., Any], tmp_path: Path) -> None:
    joints = "".join(
        f'<link name="l{number}"><inertial><mass value="1"/>'
        f'<inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link>'
        f'<joint name="j{number}" type="continuous"><parent link="base"/><child link="l{number}"/>'
        f'<origin xyz="0 {number} 1"/><axis xyz="0 0 1"/><limit effort="100" velocity="10"/></joint>'
        for number in range(3)
    )
    motors = "".join(
        f'<joint name="j{number}"><command_interface name="{quantity}"/><state_interface name="position"/></joint>'
        for number, quantity in enumerate(("position", "velocity", "position"))
    )
    (tmp_path / "mixed.urdf").write_text(
        '<robot name="mixed"><link name="base"><inertial><mass value="50"/>'
        '<inertia ixx="9" iyy="9" izz="9" ixy="0" ixz="0" iyz="0"/></inertial><collision><geometry>'
        f'<box size="1 1 0.2"/></geometry></collision></link>{joints}<ros2_control name="m" type="system">'
        f"<hardware><plugin>topic_based_ros2_control/TopicBasedSystem</plugin></hardware>{motors}</ros2_control></robot>"
    )
    sim, desk = start(
        f"mixed = Robot({str(tmp_path / 'mixed.urdf')!r}, name='mixed'); mixed.translate(x=5, z=0.2)\n"
        "motors = Armature(armature_name='mixed_joints'); mixed.append(motors)\n"
        "seen = ArmaturePose(); motors.append(seen)\n"
        "motors.add_stream('ros2', topic='/robot_joint_command')\nseen.add_stream('ros2', topic='/robot_joint_states')"
    )
    message = {"name": ["j0", "j1", "j2"], "position": [0.4, -0.3], "velocity": [0.5]}
    desk.send_bytes("/robot_joint_command", cdr.encode("sensor_msgs/msg/JointState", message))
    sim.step(120)
    state = desk.last("/robot_joint_states")
    angles = dict(zip(state.name, state.position, strict=True))
    assert (angles["j0"], angles["j2"]) == pytest.approx((0.4, -0.3), abs=0.05)
    assert angles["j1"] == pytest.approx(0.5 * 2.0, rel=0.15), "rad, after 2 s"


@pytest.mark.parametrize(
    ("topic", "message", "expected"),
    [
        ("commands", {"data": [0.1]}, "1 numbers for 7 joints: kuka_1, kuka_2"),
        (
            "joint_trajectory",
            {"joint_names": ["kuka_9"], "points": [{"positions": [1.0]}]},
            "there is no joint 'kuka_9'",
        ),
        ("joint_trajectory", {"joint_names": ["kuka_1"], "points": [{}, {}]}, "0 positions for 1 joint_names"),
        ("joint_trajectory", {"joint_names": ["kuka_1"]}, "0 points"),
        (
            "joint_trajectory",
            {"joint_names": ["kuka_1"], "points": [{"positions": [1.0], "time_from_start": {"sec": 1}}] * 2},
            "expected a larger value than that of the previous point",
        ),
    ],
)
def test_commands_that_do_not_fit_are_refused(
    start: Callable[..., Any], caplog: pytest.LogCaptureFixture, topic: str, message: dict[str, Any], expected: str
) -> None:
    sim, desk = start(ARM)
    desk.send_bytes(f"/robot/arm/{topic}", cdr.encode(desk.subscriptions[f"/robot/arm/{topic}"][0], message))
    sim.step(2)
    assert expected in caplog.text


class Car:
    _base, _limit = 2.5, 0.6
    turning_speed = MotionVWAckermann.turning_speed


class Bound:
    component = Car()


class Stream:
    kwargs = {"stamped": False}  # noqa: RUF012 - nobody changes it


@pytest.mark.parametrize(
    ("speed", "angle", "expected"),
    [(2.0, 0.3, 2.0 * math.tan(0.3) / 2.5), (-1.0, 0.3, -math.tan(0.3) / 2.5), (0.0, 0.5, 0.0)],
)
def test_the_angle_of_the_steering_of_a_car(speed: float, angle: float, expected: float) -> None:
    # the single-track model: w = v tan(angle) / wheel base
    inlets = {inlet.type: inlet for inlet in Ros2Topics().take_twist(Stream(), Bound())}  # type: ignore[arg-type]
    inlet = inlets["ackermann_msgs/msg/AckermannDriveStamped"]
    drive = {"speed": speed, "steering_angle": angle}
    assert inlet.other is not None
    for one, message in ((inlet, {"drive": drive}), (inlet.other, drive)):
        slots = one.take(cdr.decode(one.type, cdr.encode(one.type, message)))
        assert slots["linear"] == [speed, 0.0, 0.0]
        assert slots["angular"] == pytest.approx([0.0, 0.0, expected], abs=1e-6)


def test_a_trajectory_of_a_message_is_the_same_again(start: Callable[..., Any]) -> None:
    """An actuator calls its service when it reads the message, after others have obeyed commands in the same tick."""
    sim, desk = start(f"{ARM}\nother = MotionVW('other')\nrobot.append(other)")
    times = [{"sec": 0, "nanosec": 200_000_000}, {"sec": 0, "nanosec": 500_000_000}]
    points = [
        {"positions": [share * angle for angle in ANGLES], "time_from_start": t}
        for share, t in zip((0.5, 1.0), times, strict=True)
    ]
    with sim.record_inputs() as recording:
        sim.step(3)
        sim.robot.other.publish({"v": 0.3})
        desk.send_bytes(
            "/robot/arm/joint_trajectory",
            cdr.encode("trajectory_msgs/msg/JointTrajectory", {"joint_names": JOINTS, "points": points}),
        )
        sim.step(60)
    wanted = sim.state_hash()
    assert {entry.kind for entry in recording.entries} == {"command", "call"}
    sim.replay(recording)
    assert sim.state_hash() == wanted
