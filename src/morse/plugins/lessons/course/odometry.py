"""Odometry, and how it drifts.

Ten times per second, the robot reports how far its wheels have driven and how far it has turned since the last
report. Write `update`, which adds these steps up to a pose. Then predict the error: if the gyroscope is wrong by a
constant turn rate, how far off is the pose after a straight drive? Write `drift`, which returns this distance.

* The robot drives along its own x axis: in a step, x grows by the distance times the cosine of the yaw, and y by the
  distance times the sine.
* In a bend, the yaw changes during the step. Use the yaw in the middle of the step.
* With a turn rate that is wrong by b, the yaw is wrong by b t after the time t. A robot that drives at the speed v
  then moves sideways at v b t: add this up over the time.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from morse.plugins.lessons.attempt import Attempt

START = '''
"""Odometry."""

pose = [0.0, 0.0, 0.0]  # x, y (m) and yaw (rad)


def update(way, turn):
    """Add a step, and return the pose (x, y, yaw): m and rad, yaw from -pi to pi.

    Args:
        way: the distance that the robot has driven since the last step, m.
        turn: how far it has turned to the left, rad.
    """
    return pose[0], pose[1], pose[2]


def drift(bias, speed, seconds):
    """Return how far off the pose is, m, after a straight drive with a gyroscope that is wrong by `bias`, rad/s."""
    return 0.0
'''


def scene() -> None:
    from morse.builder import ATRV, Environment, MotionVW, Pose

    robot = ATRV("robot")
    motion = MotionVW("motion")
    robot.append(motion)
    pose = Pose("pose")
    robot.append(pose)

    env = Environment("empty")
    env.set_camera_location([2.0, -9.0, 7.0])
    env.set_camera_rotation([0.9, 0.0, 0.0])
    env.show(overlays=["trails"])


def check(attempt: Attempt) -> None:
    robot = attempt.simulation.robot
    before, guess = (0.0, 0.0, 0.0), attempt.numbers(3, "update", 0.0, 0.0)
    worst = turned = widest = 0.0
    for k in range(400):
        robot.motion.publish({"v": 1.0, "w": 0.5 if k < 200 else -0.4})
        attempt.step(0.1)
        true = robot.pose.data["x"], robot.pose.data["y"], robot.pose.data["yaw"]
        x, y, yaw = before
        way, turn = math.dist(true[:2], (x, y)), math.remainder(true[2] - yaw, math.tau)
        if turn:  # wheels measure the arc
            way *= (turn / 2) / math.sin(turn / 2)
        guess = attempt.numbers(3, "update", way, turn)
        before, widest = true, max(widest, abs(guess[2]))
        worst = max(worst, math.dist(guess[:2], true[:2]))
        turned = max(turned, abs(math.remainder(guess[2] - true[2], math.tau)))
    attempt.expect(
        turned < 0.01, "The yaw is right within 0.01 rad.", f"It is up to {turned:.2f} rad off: add up the turns."
    )
    attempt.expect(
        0.0 < widest <= math.pi + 1e-9,
        "The yaw stays between -pi and pi.",
        f"It gets as far as {widest:.2f}: math.remainder helps." if widest else "It stays 0.",
    )
    attempt.expect(
        worst < 0.5,
        "The position is right within 0.5 m.",
        f"It is up to {worst:.2f} m off: use the cosine of the yaw for x, and the sine for y.",
    )
    attempt.expect(
        worst < 0.02,
        "The position is right within 2 cm during the whole drive of 40 m.",
        f"It is up to {100 * worst:.1f} cm off: use the yaw in the middle of the step.",
    )
    for bias, speed, seconds in ((0.01, 1.0, 10.0), (0.02, 0.5, 30.0)):
        off = attempt.number("drift", bias, speed, seconds)
        expected = speed * bias * seconds**2 / 2
        attempt.expect(
            abs(abs(off) - expected) < 0.1 * expected,
            f"The drift of {bias:g} rad/s at {speed:g} m/s after {seconds:g} s is right within 10 %.",
            f"drift() returns {off:.3g} m: the yaw is off by b t, so the robot moves sideways at v b t.",
        )
