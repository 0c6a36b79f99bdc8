# ruff: noqa: F403, F405
from morse.builder import *

for name, kind, x, y, heading in (
    ("morsy", Morsy, 0.6, -0.6, 0.5),
    ("atrv", ATRV, 7.0, -6.8, 0.0),
    ("pioneer", Pioneer3DX, 17.6, 0.0, 1.57),
):
    robot = kind(name)
    robot.translate(x, y, 0.1 if kind is not Morsy else 0.0)
    robot.rotate(0.0, 0.0, heading)
    motion = MotionVW("motion")
    robot.append(motion)
    laser = Hokuyo("laser")
    laser.translate(0.2, 0.0, 0.5)
    robot.append(laser)
    robot.add_default_interface("socket")

env = Environment("indoors-1/office")
