"""Dock at a marker.

An orange post, 0.3 m wide, stands in front of a charging station. Write `step`, which gets a picture ten times per
second, so that the robot drives to the post, and stops with its camera 1 m in front of it and directed at it. The
camera has 64 by 48 pixels and sees 65 degrees. The robot starts at three places; at one of them, it looks away from
the post.

* Orange has much red, some green and almost no blue. In which columns is the post? Turn until it is in the middle.
* How many columns does it fill? At a distance d, a post of 0.3 m is 50 * 0.3 / d pixels wide.
* If there is no post in the picture, turn until there is one.
* Return (0, 0) for a second, and the robot has arrived.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from morse.plugins.lessons.attempt import at

if TYPE_CHECKING:
    from morse.plugins.lessons.attempt import Attempt

START = '''
"""Dock at an orange post."""


def step(image):
    """Return the speed, m/s, and the turn rate, rad/s, for a picture; (0, 0) when the robot has arrived.

    Args:
        image: rows of pixels, (48, 64, 4): red, green, blue and opacity, from 0 to 255; column 0 is left.
    """
    return 0.0, 0.0
'''

#: places of the robot: x, y (m), yaw (rad)
_PLACES = [(0.0, 0.0, 0.0), (0.5, 2.0, -0.4), (-1.0, -1.5, 2.5)]
_POST = (4.0, 0.0)
#: half of the depth of the post, m
_HALF = 0.15


def scene() -> None:
    from morse.builder import ATRV, Cube, Cylinder, Environment, MotionVW, Pose, VideoCamera

    robot = ATRV("robot")
    motion = MotionVW("motion")
    robot.append(motion)
    pose = Pose("pose")
    robot.append(pose)
    camera = VideoCamera("camera")
    camera.translate(x=0.4, z=0.6)
    camera.properties(cam_width=64, cam_height=48, cam_focal=25.0)
    camera.frequency(10)
    robot.append(camera)

    post = Cylinder("post")
    post.location = (4.0, 0.0, 0.6)
    post.scale = (0.15, 0.15, 0.6)
    post.set_color(1.0, 0.35, 0.0)
    post.static()
    station = Cube("station")
    station.location = (5.0, 0.0, 0.4)
    station.scale = (0.3, 0.8, 0.4)
    station.set_color(0.2, 0.3, 0.4)
    station.static()

    env = Environment("empty")
    env.set_camera_location([1.5, -7.0, 4.0])
    env.set_camera_rotation([1.1, 0.0, 0.0])
    env.show(overlays=["trails"])


def check(attempt: Attempt) -> None:
    for x, y, yaw in _PLACES:
        robot = attempt.load(attempt.scene).robot
        robot.place([x, y, 0.1, 0.0, 0.0, yaw])
        contacts, still = robot.contacts(), 0
        for _ in range(600):
            v, w = attempt.numbers(2, "step", robot.camera.data["image"])
            robot.motion.publish({"v": max(-1.0, min(1.0, v)), "w": max(-1.5, min(1.5, w))})
            attempt.step(0.1)
            still = still + 1 if abs(v) < 0.01 and abs(w) < 0.01 else 0
            if still >= 10 or contacts.touched:
                break
        start = f"from ({x:g}, {y:g}), {math.degrees(yaw):.0f} degrees"
        place = robot.pose.data["x"], robot.pose.data["y"]
        gap = math.dist(place, _POST) - _HALF
        bearing = math.remainder(math.atan2(-place[1], _POST[0] - place[0]) - robot.pose.data["yaw"], math.tau)
        drives = math.dist(place, (x, y)) > 0.5
        attempt.expect(
            drives and not contacts.touched,
            f"The robot drives and touches nothing, {start}.",
            "It has driven into the post or the station." if contacts.touched else f"It stays at {at(*place)} m.",
        )
        attempt.expect(
            drives and still >= 10,
            f"The robot stops, {start}.",
            "This counts when it has driven."
            if not drives
            else "It has touched something before."
            if contacts.touched
            else "It still moves after 60 s: return (0, 0) when it has arrived.",
        )
        side = "left" if bearing > 0.0 else "right"
        attempt.expect(
            0.5 < gap - 0.4 < 1.5 and abs(bearing) < 0.2,
            f"Its camera is 1 m in front of the post, within 0.5 m, and looks at it, {start}.",
            f"It is {gap - 0.4:.2f} m away, and the post is {abs(math.degrees(bearing)):.0f} degrees to the {side}.",
        )
