# ruff: noqa: F403, F405
from morse.builder import *

robot = Morsy()
robot.translate(1.0, 0.0, 0.0)
robot.rotate(0.0, 0.0, 3.5)

motion = MotionVW()
robot.append(motion)
keyboard = Keyboard()
robot.append(keyboard)
pose = Pose()
robot.append(pose)
laser = Hokuyo()
laser.translate(0.0, 0.0, 0.4)
robot.append(laser)
robot.add_default_interface("socket")

env = Environment("sandbox")
env.set_camera_location([-4.5, -3.2, 2.6])
env.set_camera_rotation([1.25, 0.0, -1.02])
env.set_camera_focal_length(28.0)
