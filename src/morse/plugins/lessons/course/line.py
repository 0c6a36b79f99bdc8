"""Follow a line.

A camera at the front of the robot looks down at a dark line on a light floor. Write `step`, which gets the picture
ten times per second, so that the robot follows the line once around the course, counterclockwise, in at most 90 s. It
starts on the line and looks along it.

* Look at one row of the picture. In which columns is it dark? Their mean is where the line is. Red, green and blue of
  the line are below 80, those of the floor above 140.
* If the line is in the left half, turn left: `w` is positive. The farther it is from the middle, the more the robot
  has to turn.
* Drive more slowly in bends than on straight parts.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from morse.plugins.lessons.attempt import at

if TYPE_CHECKING:
    from morse.plugins.lessons.attempt import Attempt

START = '''
"""Follow a line."""


def step(image):
    """Return the speed, m/s, and the turn rate, rad/s (to the left is positive), for a picture.

    Args:
        image: rows of pixels, (48, 64, 4): red, green, blue and opacity, from 0 to 255.
            Row 0 is far away, column 0 is left.
    """
    row = image[24]
    return 0.0, 0.0
'''

#: half of the straight parts, and the radius of the bends, m
_HALF, _RADIUS = 3.0, 2.0
#: largest mean distance to the line, m, and simulated seconds
_NEAR, _SECONDS = 0.25, 90.0
#: distance to the line at which the check ends, m
_LOST = 1.5


def scene() -> None:
    import math

    from morse.builder import ATRV, Environment, MotionVW, Plane, Pose, VideoCamera

    robot = ATRV("robot")
    robot.translate(x=0.0, y=-2.0)
    motion = MotionVW("motion")
    robot.append(motion)
    pose = Pose("pose")
    robot.append(pose)
    camera = VideoCamera("camera")
    camera.translate(x=0.4, z=0.9)
    camera.rotate(y=-0.9)
    camera.properties(cam_width=64, cam_height=48, cam_focal=25.0)
    camera.frequency(10)
    robot.append(camera)

    def strip(number, x, y, yaw, length):
        part = Plane(f"strip_{number}")
        part.location = (x, y, 0.006)
        part.rotation_euler = (0.0, 0.0, yaw)
        part.scale = (length / 2, 0.08, 1.0)
        part.set_color(0.02, 0.02, 0.02)

    for side in (-1, 1):
        strip(f"{side}", 0.0, 2.0 * side, 0.0, 6.1)
        for k in range(12):
            angle = math.pi * (k + 0.5) / 12 - math.pi / 2
            x, y = side * (3.0 + 2.0 * math.cos(angle)), 2.0 * math.sin(angle)
            strip(f"{side}_{k}", x, y, side * (angle + math.pi / 2), 0.56)

    env = Environment("empty")
    env.set_camera_location([0.0, -7.0, 7.0])
    env.set_camera_rotation([0.8, 0.0, 0.0])
    env.show(overlays=["trails"], follow=robot)


def distance(x: float, y: float) -> float:
    """The distance of a place to the line, m."""
    if abs(x) <= _HALF:
        return abs(abs(y) - _RADIUS)
    return abs(math.hypot(abs(x) - _HALF, y) - _RADIUS)


def check(attempt: Attempt) -> None:
    robot = attempt.simulation.robot
    marks = [(5.0, 0.0), (0.0, 2.0), (-5.0, 0.0), (0.0, -2.0)]
    missing, off, steps, is_lost = list(marks), 0.0, 0, False
    while missing and steps < _SECONDS * 10:
        v, w = attempt.numbers(2, "step", robot.camera.data["image"])
        robot.motion.publish({"v": max(-1.0, min(1.0, v)), "w": max(-1.5, min(1.5, w))})
        attempt.step(0.1)
        place = robot.pose.data["x"], robot.pose.data["y"]
        off, steps = off + distance(*place), steps + 1
        is_lost = distance(*place) > _LOST
        if is_lost:
            break
        if math.dist(place, missing[0]) < 0.8:
            missing.pop(0)
    where = at(robot.pose.data["x"], robot.pose.data["y"])
    end = f"It has lost the line at {where} m." if is_lost else f"After {steps / 10:.0f} s it is at {where} m."
    attempt.expect(len(missing) < len(marks), "The robot comes to the middle of the first bend, at (5, 0) m.", end)
    attempt.expect(
        not missing,
        "It comes around within 90 s.",
        f"It has driven {len(marks) - len(missing)} of the 4 quarters. {end}",
    )
    attempt.expect(
        not missing and off / steps < _NEAR,
        "Its mean distance to the line is below 0.25 m.",
        f"It is {off / steps:.2f} m: look farther ahead, or turn more for the same error."
        if not missing
        else "This is measured when it has come around.",
    )
