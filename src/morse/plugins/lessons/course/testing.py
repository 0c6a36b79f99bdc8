"""Test a program.

A program has to stop a robot between 0.5 m and 1.5 m before a wall, wherever the robot starts, and must not drive
faster than 1 m/s, forwards or backwards. You get four programs, one of which is right. Write `is_right`, which tests
a program by driving with it.

* Drive from several places: far from the wall, and nearer to it than the robot may stop.
* Look at the speed in each step, at the distance at the end, and at whether the robot has touched the wall.
"""

from __future__ import annotations

import reprlib
from typing import TYPE_CHECKING

from morse.plugins.lessons.attempt import WrongProgramError

if TYPE_CHECKING:
    from collections.abc import Callable

    from morse.plugins.lessons.attempt import Attempt

START = '''
"""Test a program."""


def is_right(program, drive):
    """Return whether a program is right.

    Args:
        program: a function of the distance to the wall, m, that returns the speed, m/s.
        drive: a function that drives with a program for 15 s: `drive(program, 3.0)` starts 3 m before the wall and
            returns the distances and the speeds of all steps, two lists, and whether the robot has touched the wall.
    """
    return True
'''


def scene() -> None:
    from morse.builder import ATRV, Cube, Environment, Infrared, MotionVW, Pose

    robot = ATRV("robot")
    motion = MotionVW("motion")
    robot.append(motion)
    pose = Pose("pose")
    robot.append(pose)
    sonar = Infrared("sonar")
    sonar.properties(laser_range=10.0)
    sonar.translate(x=0.6, z=0.3)
    robot.append(sonar)
    wall = Cube("wall")
    wall.location = (6.1, 0.0, 0.5)
    wall.scale = (0.1, 3.0, 0.5)
    wall.set_color(0.75, 0.72, 0.65)
    wall.static()

    env = Environment("empty")
    env.set_camera_location([3.0, -7.0, 4.0])
    env.set_camera_rotation([1.1, 0.0, 0.0])
    env.show(plots=["robot.pose.x"])


def _right(distance: float) -> float:
    return max(-1.0, min(1.0, distance - 1.0))


def _too_fast(distance: float) -> float:
    return 2.0 * max(-0.5, min(1.0, distance - 1.0))


def _too_late(distance: float) -> float:
    return 1.0 if distance > 0.3 else 0.0


def _never_backwards(distance: float) -> float:
    return max(0.0, min(1.0, distance - 1.0))


_PROGRAMS = {
    "the right program": (_right, True),
    "the program that drives 2 m/s": (_too_fast, False),
    "the program that brakes too late": (_too_late, False),
    "the program that never backs up from a wall that is too near": (_never_backwards, False),
}


def check(attempt: Attempt) -> None:
    simulation = attempt.simulation
    robot, contacts = simulation.robot, simulation.robot.contacts()
    runs = 0

    def drive(program: Callable[[float], float], distance: float) -> tuple[list[float], list[float], bool]:
        nonlocal runs
        runs += 1
        if runs > 60:
            raise RuntimeError("60 drives are enough")
        robot.place([5.4 - max(0.1, min(5.4, float(distance))), 0.0, 0.0])
        touched, distances, speeds = False, [], []
        for _ in range(150):
            simulation.measure()
            distances.append(float(min(robot.sonar.data["range_list"])))
            speeds.append(float(program(distances[-1])))
            robot.motion.publish({"v": speeds[-1], "w": 0.0})
            attempt.step(0.1)
            touched = touched or contacts.touched
        return distances, speeds, touched

    for name, (program, is_right) in _PROGRAMS.items():
        runs = 0
        says = attempt.call("is_right", lambda distance, move=program: move(distance), drive)  # without its name
        if type(says).__name__ not in ("bool", "bool_"):  # also of numpy
            raise WrongProgramError(f"is_right() returned {reprlib.repr(says)}, expected True or False")
        attempt.expect(
            runs and bool(says) is is_right,
            f"It is right about {name}.",
            f"is_right() returns {says!r:.20} after {runs} drives."
            if runs
            else "This counts when is_right() has called drive().",
        )
