"""Follow a wall.

The robot has a laser scanner with 181 rays, one per degree: ray 0 points to the right, ray 90 straight ahead, ray 180
to the left. Write `step`, which gets a scan ten times per second, so that the robot drives once around the room, with
the wall 1 m to its right, in at most 120 s. It must not touch anything.

* The distance to the wall is the shortest of the rays 0 to 60. If it is too short, turn left; if it is too long, turn
  right.
* A wall ahead shows in the rays around 90: turn left before you reach it.
* A robot that looks only at the distance swings from side to side. The number of the shortest ray says how the robot
  is turned: beside the wall and parallel to it, ray 0 is the shortest.
* Part of the wall protrudes into the room. Behind its corner, turn right, and slowly.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from morse.plugins.lessons.attempt import at

if TYPE_CHECKING:
    from morse.plugins.lessons.attempt import Attempt

START = '''
"""Follow a wall at the right, 1 m away."""


def step(ranges):
    """Return the speed, m/s, and the turn rate, rad/s (to the left is positive), for a scan.

    Args:
        ranges: 181 distances, m, from the right (0) over ahead (90) to the left (180); 10 where nothing is hit.
    """
    return 0.0, 0.0
'''

_SECONDS = 120.0


def scene() -> None:
    from morse.builder import ATRV, Cube, Environment, MotionVW, Pose, Sick

    robot = ATRV("robot")
    robot.translate(x=0.0, y=-2.6)
    motion = MotionVW("motion")
    robot.append(motion)
    pose = Pose("pose")
    robot.append(pose)
    laser = Sick("laser")
    laser.translate(x=0.3, z=0.6)
    laser.properties(laser_range=10.0, scan_window=180.0, resolution=1.0)
    laser.frequency(10)
    robot.append(laser)

    def wall(number, x, y, length, width):
        part = Cube(f"wall_{number}")
        part.location = (x, y, 0.5)
        part.scale = (length / 2, width / 2, 0.5)
        part.set_color(0.75, 0.72, 0.65)
        part.static()

    wall(1, 0.0, -4.0, 12.0, 0.2)
    wall(2, 0.0, 4.0, 12.0, 0.2)
    wall(3, -6.0, 0.0, 0.2, 8.0)
    wall(4, 6.0, 0.0, 0.2, 8.0)
    wall(5, 4.5, 3.0, 3.0, 2.0)

    env = Environment("empty")
    env.set_camera_location([0.0, -10.0, 9.0])
    env.set_camera_rotation([0.8, 0.0, 0.0])
    env.show(overlays=["trails"], rays=[laser])


def check(attempt: Attempt) -> None:
    robot = attempt.simulation.robot
    contacts = robot.contacts()
    marks = [(4.8, 0.0), (0.0, 2.8), (-4.8, 0.0), (0.0, -2.8)]
    missing, errors, steps = list(marks), [], 0
    while missing and steps < _SECONDS * 10 and not contacts.touched:
        ranges = list(robot.laser.data["range_list"])
        v, w = attempt.numbers(2, "step", ranges)
        robot.motion.publish({"v": max(-1.0, min(1.0, v)), "w": max(-1.5, min(1.5, w))})
        attempt.step(0.1)
        errors.append(abs(min(ranges[:60]) - 1.0))
        steps += 1
        place = robot.pose.data["x"], robot.pose.data["y"]
        if math.dist(place, missing[0]) < 1.3:
            missing.pop(0)
    end = at(robot.pose.data["x"], robot.pose.data["y"])
    drives = len(missing) < len(marks)
    attempt.expect(
        drives and not contacts.touched,
        "The robot touches nothing.",
        f"It drives into a wall at {end} m."
        if contacts.touched
        else "This counts when it has driven along the first side.",
    )
    attempt.expect(
        not missing,
        "It comes around within 120 s.",
        f"It has driven along {len(marks) - len(missing)} of the 4 sides, and is at {end} m at the end.",
    )
    mean = sum(errors) / max(1, len(errors))
    attempt.expect(
        not missing and mean < 0.35,
        "It stays 1 m from the wall: the mean error is below 0.35 m.",
        f"The mean error is {mean:.2f} m." if not missing else "This is measured when it has come around.",
    )
