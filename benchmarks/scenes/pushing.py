"""Robots on the ground that push crates ahead of them, each with a pose. Argument: ``count=50``."""

import sys

from benchmarks import work
from morse.builder import *

ASKED = {"count": "50"}
ASKED.update(word.split("=") for word in sys.argv[1:] if "=" in word)


def movable(made):
    game = made._bpy_object.game
    game.physics_type = "RIGID_BODY"
    game.use_collision_bounds = True
    return made


def crate(number, x, y):
    made = movable(Cube(f"crate{number}"))
    made.scale = (work.CRATE / 2, work.CRATE / 2, work.CRATE / 2)
    made._bpy_object.game.mass = work.CRATE_MASS
    made.location = (x, y, work.CRATE / 2)


for number, (x, y) in enumerate(work.pushing_starts(int(ASKED["count"]))):
    crate(number, x + work.CRATE_AHEAD, y)
    robot = Robot(name=f"r{number}")
    robot.properties(GroundRobot=True)
    body = movable(Cylinder(f"body{number}"))
    body._bpy_object.game.collision_bounds_type = "CYLINDER"
    body.scale = (work.RADIUS, work.RADIUS, work.HEIGHT / 2)
    body.location = (0, 0, work.HEIGHT / 2)
    robot.append(body)
    robot.set_rigid_body()
    robot.set_mass(work.MASS)
    robot.translate(x, y, 0.0)
    robot.append(MotionVW(f"motion{number}"))
    robot.append(Pose(f"pose{number}"))

env = Environment("empty", fastmode=True)
