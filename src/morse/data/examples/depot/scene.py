"""Conveyors: a robot takes boxes from the end of a belt, and stores them in bays."""

from morse.builder import *

STEEL, SHELF, MARK = (0.2, 0.32, 0.55), (0.85, 0.45, 0.1), (0.9, 0.75, 0.1)


def block(name, place, size, color):
    """A box that stands still: its middle and its size, m."""
    box = Cube(name)
    box.scale = tuple(side / 2 for side in size)
    box.translate(*place)
    box.set_color(*color)
    box.static()


block("wall north", (2.0, 8.0, 2.0), (24.0, 0.2, 4.0), (0.75, 0.76, 0.74))
block("wall west", (-10.0, 0.0, 2.0), (0.2, 16.0, 4.0), (0.75, 0.76, 0.74))
for row in range(3):
    for side in (-1, 1):
        block(f"post {row} {side}", (9.0 + 1.4 * side, 4.0 + 1.5 * row, 1.2), (0.1, 0.1, 2.4), STEEL)
    for level in range(1, 4):
        block(f"board {row} {level}", (9.0, 4.0 + 1.5 * row, 0.8 * level), (2.9, 0.9, 0.05), SHELF)
for bay in range(3):
    block(f"bay {bay}", (6.0, -2.0 - 1.5 * bay, 0.002), (1.2, 1.1, 0.004), MARK)

source = Dispenser("source", stock=12, height=0.32)
source.translate(x=-7.0, y=3.0)
first = Conveyor("first", length=5.0, height=0.3, speed=0.6)
first.translate(x=-7.3, y=3.0)
curve = Conveyor("curve", length=2.0, turn=-1.5708, height=0.3, speed=0.6, rails=True)
curve.translate(x=-2.3, y=3.0)
last = Conveyor("last", length=2.0, height=0.3, speed=0.6)
last.translate(x=-1.027, y=1.727)
last.rotate(z=-1.5708)
block("stop", (-1.027, -0.3, 0.2), (0.7, 0.06, 0.4), STEEL)

robot = Morsy()
robot.translate(1.5, 0.2, 0.0)
motion = MotionVW()
robot.append(motion)
pose = Pose()
robot.append(pose)
gripper = Gripper()
gripper.translate(x=0.55, z=0.4)
gripper.rotate(y=1.5708)  # the fingers point forward
gripper.properties(Distance=1.4, Angle=90.0)
robot.append(gripper)
robot.add_default_interface("socket")
source.add_service("socket")
last.add_service("socket")

env = Environment("empty")
env.set_camera_location([7.5, -9.0, 5.5])
env.set_camera_rotation([1.12, 0.0, 0.52])
