# ruff: noqa: F403, F405
from morse.builder import *

for name, kind, x, y, heading in (
    ("jido", Jido, 7.0, 1.0, 2.6),
    ("b21", B21, -3.0, 0.0, 0.0),
    ("pioneer", Pioneer3DX, 10.5, -4.5, 1.2),
):
    robot = kind(name)
    robot.translate(x, y, 0.1)
    robot.rotate(0.0, 0.0, heading)
    motion = MotionVW("motion")
    robot.append(motion)
    laser = Sick("laser")
    laser.translate(0.3, 0.0, 0.4)
    robot.append(laser)
    robot.add_default_interface("socket")

env = Environment("indoors-1/warehouse")
