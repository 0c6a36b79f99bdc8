# ruff: noqa: F403, F405
from morse.builder import *

for name, kind, x, y, heading in (
    ("atrv", ATRV, -1.0, 0.5, 0.4),
    ("pioneer", Pioneer3DX, 1.5, -1.0, 2.0),
    ("morsy", Morsy, 3.0, 1.2, -2.5),
):
    robot = kind(name)
    robot.translate(x, y, 0.1)
    robot.rotate(0.0, 0.0, heading)
    motion = MotionVW("motion")
    robot.append(motion)
    laser = Sick("laser")
    laser.translate(0.2, 0.0, 0.5)
    robot.append(laser)
    robot.add_default_interface("socket")

env = Environment("indoors-1/indoor-1")
env.set_camera_location([6.5, -5.5, 4.5])
env.set_camera_rotation([1.05, 0.0, 0.8])
env.set_camera_focal_length(24.0)
