"""Learn a gain.

A robot starts beside a line and steers back to it: the farther it is from the line, the faster it turns towards it.
The gain says how fast, in rad/s for each metre. With a small gain the robot returns slowly, with a large one it
swings. Write `learn`, which may try 30 gains, a test drive for each, and returns a good one.

* Try ten gains from 0 to 10 first. With which one is the mean distance to the line the smallest?
* Then try ten gains between the two neighbours of this one.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from morse.plugins.lessons.attempt import Attempt

START = '''
"""Learn a gain."""


def learn(cost):
    """Return a good gain between 0 and 10.

    Args:
        cost: a function: `cost(2.5)` drives with the gain 2.5 and returns the mean distance to the line, m. It may be
            called 30 times.
    """
    return 0.0
'''

_CALLS = 30


def scene() -> None:
    from morse.builder import ATRV, Environment, MotionVW, Plane, Pose

    robot = ATRV("robot")
    robot.translate(y=1.0)
    motion = MotionVW("motion")
    robot.append(motion)
    pose = Pose("pose")
    robot.append(pose)

    line = Plane("line")
    line.location = (4.0, 0.0, 0.006)
    line.scale = (6.0, 0.05, 1.0)
    line.set_color(0.02, 0.02, 0.02)

    env = Environment("empty")
    env.set_camera_location([3.0, -7.0, 5.0])
    env.set_camera_rotation([1.0, 0.0, 0.0])
    env.show(overlays=["trails"])


def check(attempt: Attempt) -> None:
    simulation = attempt.simulation
    start = simulation.save()
    driven: dict[float, float] = {}

    def drive(gain: float) -> float:
        if gain not in driven:
            simulation.restore(start)
            distances = []
            for _ in range(60):
                simulation.measure()
                pose = simulation.robot.pose.data
                turn = -gain * pose["y"] - 1.5 * pose["yaw"]
                simulation.robot.motion.publish({"v": 1.0, "w": max(-1.5, min(1.5, turn))})
                attempt.step(0.1)
                distances.append(abs(pose["y"]))
            driven[gain] = math.fsum(distances) / len(distances)
        return driven[gain]

    calls = 0

    def cost(gain: float) -> float:
        nonlocal calls
        calls += 1
        if calls > _CALLS:
            raise RuntimeError(f"{_CALLS} gains have been tried")
        return drive(max(0.0, min(10.0, float(gain))))

    gain = attempt.number("learn", cost)
    attempt.expect(calls, "It tries gains.", "learn() has not called cost().")
    is_within = 0.0 <= gain <= 10.0
    attempt.expect(
        calls and is_within,
        "The gain is between 0 and 10.",
        f"It is {gain:g}." if not is_within else "This counts when gains have been tried.",
    )
    mean, best = drive(max(0.0, min(10.0, gain))), min(drive(0.25 * k) for k in range(1, 20))
    attempt.expect(
        calls and is_within and mean <= 1.05 * best,
        "It is at most 5 % worse than the best one.",
        f"With {gain:.2f}, the mean distance is {mean:.3f} m; {best:.3f} m are possible."
        if is_within
        else "This counts when the gain is between 0 and 10.",
    )
