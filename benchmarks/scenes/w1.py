"""N round robots on a floor between walls and boxes, each with a pose and, if asked, a laser scanner.

Arguments: the number of robots; ``planar`` or ``wheels``; ``scan`` or ``pose``.
"""

import sys
from pathlib import Path

from morse.builder import *

sys.path.insert(0, str(Path(__file__).parents[1]))
import work

COUNT = int(sys.argv[1])
SCAN = sys.argv[3] == "scan"


def block(name, x, y, z, sx, sy, sz):
    made = Cube(name)
    made.scale = (sx / 2, sy / 2, sz / 2)
    made.location = (x, y, z)
    made._bpy_object.game.physics_type = "STATIC"


block("Floor", 0, 0, -0.5, 26, 26, 1)
for number, sizes in enumerate(work.walls() + work.boxes()):
    block(f"Block{number}", *sizes)

robots = []
for number, (x, y, yaw) in enumerate(work.starts(COUNT)):
    robot = Robot(name=f"r{number}")
    robot.properties(GroundRobot=True)
    body = Cylinder(f"body{number}")
    body.scale = (work.RADIUS, work.RADIUS, work.HEIGHT / 2)
    body.location = (0, 0, work.HEIGHT / 2)
    body._bpy_object.game.physics_type = "RIGID_BODY"
    body._bpy_object.game.collision_bounds_type = "CYLINDER"
    body._bpy_object.game.use_collision_bounds = True
    robot.append(body)
    robot.set_rigid_body()
    robot.set_mass(work.MASS)
    robot.translate(x, y, 0.0)
    robot.rotate(0, 0, yaw)
    motion = MotionVW(f"motion{number}")
    robot.append(motion)
    pose = Pose(f"pose{number}")
    robot.append(pose)
    if SCAN:
        laser = Sick(f"laser{number}")
        laser.translate(0, 0, work.SCAN_HEIGHT)
        robot.append(laser)
    robot.add_default_interface("socket")
    robots.append(robot)

env = Environment("empty", fastmode=True, component_renaming=False)
