"""One planar robot with a pose and a scanner between walls and boxes: a row of a batch."""

from benchmarks import work
from morse.builder import *


def block(number, x, y, z, *edges):
    cube = Cube(f"block{number}")
    cube.location, cube.scale = (x, y, z), tuple(edge / 2 for edge in edges)
    cube._bpy_object.game.physics_type = "STATIC"


for number, values in enumerate(work.row_blocks()):
    block(number, *values)

robot, body = Robot(name="robot"), Cylinder("body")
robot.properties(GroundRobot=True)
body.scale, body.location = (work.RADIUS, work.RADIUS, work.HEIGHT / 2), (0.0, 0.0, work.HEIGHT / 2)
game = body._bpy_object.game
game.physics_type, game.collision_bounds_type, game.use_collision_bounds = "RIGID_BODY", "CYLINDER", True
robot.append(body)
robot.set_rigid_body()
robot.set_mass(work.MASS)
laser = Sick("laser")
laser.translate(0.0, 0.0, work.SCAN_HEIGHT)
laser.frequency(work.SCAN_RATE)
laser.level("range")
for part in (MotionVW("motion"), Pose("pose"), laser):
    robot.append(part)
Environment("empty")
