"""Search.

A victim is somewhere in a room with walls. The robot has found it when it is within 2.5 m and no wall is between
them. The robot has a laser scanner, and knows its pose, but does not see the victim itself. Write `step`, which is
called ten times per second, so that the robot comes near the victim within 180 s, wherever it is, and touches
nothing. The victim is at four places, one after the other.

* Drive where there is space, and turn away from what is near. This alone finds the victim sometimes.
* Remember where you have been, in cells of 1 m, and prefer directions that lead to new ones.
* Or follow the walls, as in the lesson `wall`: all walls of this room are connected, so one round along them passes
  everything. It is about 80 m long.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from morse.plugins.lessons.attempt import at

if TYPE_CHECKING:
    from morse.plugins.lessons.attempt import Attempt

START = '''
"""Search a room."""


def step(pose, ranges):
    """Return the speed, m/s, and the turn rate, rad/s (to the left is positive).

    Args:
        pose: x, y (m) and yaw (rad) of the robot.
        ranges: 181 distances, m, from the right (0) over ahead (90) to the left (180); 8 where nothing is hit.
    """
    return 0.0, 0.0
'''

_PLACES = [(5.0, 5.0), (-5.0, 5.0), (-5.5, -4.5), (5.0, -5.0)]
_SECONDS, _SEES = 180.0, 2.5
_WALLS = [
    (0.0, -6.5, 13.0, 0.2),
    (0.0, 6.5, 13.0, 0.2),
    (-6.5, 0.0, 0.2, 13.0),
    (6.5, 0.0, 0.2, 13.0),
    (-2.5, 4.0, 0.2, 5.0),
    (2.5, 4.0, 0.2, 5.0),
    (2.5, -4.0, 0.2, 5.0),
    (-4.5, -1.5, 4.0, 0.2),
]


def scene() -> None:
    from morse.builder import ATRV, Cube, Environment, MotionVW, Pose, Sick, Sphere

    robot = ATRV("robot")
    motion = MotionVW("motion")
    robot.append(motion)
    pose = Pose("pose")
    robot.append(pose)
    laser = Sick("laser")
    laser.translate(x=0.3, z=0.6)
    laser.properties(laser_range=8.0, scan_window=180.0, resolution=1.0)
    laser.frequency(10)
    robot.append(laser)

    def wall(number, x, y, length, width):
        part = Cube(f"wall_{number}")
        part.location = (x, y, 0.5)
        part.scale = (length / 2, width / 2, 0.5)
        part.set_color(0.75, 0.72, 0.65)
        part.static()

    wall(1, 0.0, -6.5, 13.0, 0.2)
    wall(2, 0.0, 6.5, 13.0, 0.2)
    wall(3, -6.5, 0.0, 0.2, 13.0)
    wall(4, 6.5, 0.0, 0.2, 13.0)
    wall(5, -2.5, 4.0, 0.2, 5.0)
    wall(6, 2.5, 4.0, 0.2, 5.0)
    wall(7, 2.5, -4.0, 0.2, 5.0)
    wall(8, -4.5, -1.5, 4.0, 0.2)
    victim = Sphere("victim")
    victim.location = (5.0, 5.0, 0.3)
    victim.scale = (0.25, 0.25, 0.25)
    victim.set_color(0.9, 0.1, 0.1)

    env = Environment("empty")
    env.set_camera_location([0.0, -12.0, 13.0])
    env.set_camera_rotation([0.75, 0.0, 0.0])
    env.show(overlays=["trails"], rays=[laser])


def _sees(place, victim):
    """Whether the victim is near enough, and no wall between."""
    if math.dist(place, victim) > _SEES:
        return False
    points = [
        (place[0] + (victim[0] - place[0]) * k / 50, place[1] + (victim[1] - place[1]) * k / 50) for k in range(51)
    ]
    return not any(abs(x - wx) <= w / 2 and abs(y - wy) <= d / 2 for x, y in points for wx, wy, w, d in _WALLS)


def check(attempt: Attempt) -> None:
    for victim in _PLACES:
        simulation = attempt.load(attempt.scene)
        simulation.place("victim", [*victim, 0.3])
        robot, found, touched, steps = simulation.robot, False, False, 0
        contacts = robot.contacts()
        while not found and not touched and steps < _SECONDS * 10:
            ranges = list(robot.laser.data["range_list"])
            pose = tuple(robot.pose.data[name] for name in ("x", "y", "yaw"))
            v, w = attempt.numbers(2, "step", pose, ranges)
            robot.motion.publish({"v": max(-1.0, min(1.0, v)), "w": max(-1.5, min(1.5, w))})
            attempt.step(0.1)
            steps += 1
            place = robot.pose.data["x"], robot.pose.data["y"]
            found, touched = _sees(place, victim), contacts.touched
        name = f"the victim at ({victim[0]:g}, {victim[1]:g})"
        attempt.expect(
            found,
            f"It finds {name}.",
            f"It has touched a wall at {at(*place)} m." if touched else f"It is at {at(*place)} m after 180 s.",
        )
