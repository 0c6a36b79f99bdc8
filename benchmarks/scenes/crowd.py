"""Robots without bodies that are moved by velocities, each with a pose; or boxes that move in the view.

Argument: ``count=1000``; ``visible=yes`` for a box on each.
"""

import sys

from morse.builder import *

ASKED = {"count": "1000", "visible": "no"}
ASKED.update(word.split("=") for word in sys.argv[1:] if "=" in word)

side = int(int(ASKED["count"]) ** 0.5) + 1
for number in range(int(ASKED["count"])):
    robot = FakeRobot(f"r{number}")
    robot.translate(number % side, number // side, 0.0)
    if ASKED["visible"] == "yes":
        box = Cube(f"box{number}")
        box.scale = (0.2, 0.2, 0.2)
        box._bpy_object.game.physics_type = "NO_COLLISION"
        robot.append(box)
    robot.append(MotionVW(f"motion{number}"))
    robot.append(Pose(f"pose{number}"))

env = Environment("empty", fastmode=True)
