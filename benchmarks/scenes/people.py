"""People around walls, and a robot with a lidar of 181 rays among them.

Arguments: ``count=200``, ``model=social-force``.
"""

import sys

from morse.builder import *

ASKED = {"count": "200", "model": "social-force"}
ASKED.update(word.split("=") for word in sys.argv[1:] if "=" in word)

# four square metres for each
scale = (int(ASKED["count"]) / 200.0) ** 0.5
floor = Cube("floor")
floor.scale = (40 * scale, 30 * scale, 0.5)
floor.translate(20 * scale, 10 * scale, -0.5)
floor.static()
for number in range(10):
    wall = Cube(f"wall{number}")
    wall.scale = (0.1, 2, 1.5)
    wall.translate(4 * number * scale, 4 * scale, 1.5)
    wall.static()
crowd = Crowd("people", int(ASKED["count"]), model=ASKED["model"], groups=0.3)
crowd.start([(0, 0), (40 * scale, 20 * scale)])
crowd.goals([(40 * scale, 10), (0, 10)], then="repeat")
robot = ATRV("robot")
robot.translate(20 * scale, 10 * scale, 0.2)
robot.append(MotionVW("motion"))
scan = Sick("scan")
scan.translate(0.3, 0, 0.5)
robot.append(scan)

env = Environment("empty", fastmode=True)
