"""Commands of the controllers of ros2_control and of planners for cars."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import pytest

from morse.actuators.ackermann import MotionVWAckermann
from morse.rosmsgs import cdr
from morse.rosmsgs.kinds import Ros2Topics

if TYPE_CHECKING:
    from collections.abc import Callable

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
