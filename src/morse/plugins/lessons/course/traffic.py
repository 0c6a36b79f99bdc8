"""Two robots that must not meet.

Two robots drive on streets that cross at (0, 0): one to the east (yaw 0), the other one to the north (yaw π/2). Both
run the same program, and each knows where both are. Write `step` so that both are 4 m behind the crossing within 40
s, and never nearer than 1.5 m to each other. They start at different distances.

* Both programs are the same, so they need a rule that tells the robots apart, for instance: who comes from the right
  drives first.
* A robot that waits for ever does not arrive: drive on when the other one has passed the crossing.
* Wait far enough from the crossing: the distance counts between the centres of the robots.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from morse.plugins.lessons.attempt import Attempt

START = '''
"""Two robots on crossing streets."""


def step(me, other):
    """Return the speed of a robot along its street, from 0 to 1 m/s.

    Args:
        me: x, y (m) and yaw (rad) of this robot.
        other: the same of the other robot.
    """
    return 1.0
'''


def scene() -> None:
    import math

    from morse.builder import ATRV, Environment, MotionVW, Plane, Pose

    for name, x, y, yaw in (("east", -6.0, 0.0, 0.0), ("north", 0.0, -6.0, math.pi / 2)):
        robot = ATRV(name)
        robot.translate(x, y)
        robot.rotate(z=yaw)
        robot.append(MotionVW("motion"))
        robot.append(Pose("pose"))
        street = Plane(f"street_{name}")
        street.scale = (8.0, 1.2, 1.0)
        street.location = (0.0, 0.0, 0.004 if name == "east" else 0.006)
        street.rotation_euler = (0.0, 0.0, yaw)
        street.set_color(0.12, 0.12, 0.13)

    env = Environment("empty")
    env.set_camera_location([6.0, -10.0, 10.0])
    env.set_camera_rotation([0.85, 0.0, 0.5])
    env.show(overlays=["trails"])


#: places along their streets at which both start, m
_STARTS = [(-6.0, -6.0), (-6.0, -4.5), (-4.0, -5.5), (-3.0, -8.0)]


def check(attempt: Attempt) -> None:
    for east, north in _STARTS:
        simulation = attempt.load(attempt.scene)
        robots = simulation.east, simulation.north
        simulation.east.place([east, 0.0, 0.1, 0.0, 0.0, 0.0])
        simulation.north.place([0.0, north, 0.1, 0.0, 0.0, math.pi / 2])
        attempt.step(0.1)
        nearest = math.inf
        for _ in range(400):
            poses = [tuple(robot.pose.data[name] for name in ("x", "y", "yaw")) for robot in robots]
            along = poses[0][0], poses[1][1]
            nearest = min(nearest, math.dist(poses[0][:2], poses[1][:2]))
            if min(along) > 4.0:
                break
            for k, robot in enumerate(robots):
                v = attempt.number("step", poses[k], poses[1 - k])
                # a street ends behind the crossing
                robot.motion.publish({"v": max(0.0, min(1.0, v)) if along[k] < 5.0 else 0.0, "w": 0.0})
            attempt.step(0.1)
        start = f"from {-east:g} m west and {-north:g} m south of the crossing"
        attempt.expect(
            nearest >= 1.5,
            f"They keep 1.5 m, {start}.",
            f"They come as near as {nearest:.2f} m: one of the two has to wait.",
        )
        attempt.expect(
            nearest >= 1.5 and min(along) > 4.0,
            f"Both arrive, {start}.",
            f"After 40 s one is at x = {along[0]:.1f} m, the other one at y = {along[1]:.1f} m."
            if min(along) <= 4.0
            else "This counts when they keep 1.5 m.",
        )
