"""Commands of the controllers of ros2_control and of planners for cars."""

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from morse.actuators.ackermann import MotionVWAckermann
from morse.rosmsgs import cdr
from morse.rosmsgs.kinds import Ros2Topics

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
