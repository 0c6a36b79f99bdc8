"""Wheels: a Pioneer drives a square, and compares its odometry with its true pose."""

from morse.builder import *

robot = Pioneer3DX()

motion = MotionVWDiff()
robot.append(motion)

odometry = Odometry()
odometry.level("integrated")
robot.append(odometry)

pose = Pose()
robot.append(pose)

robot.add_default_interface("socket")

env = Environment("indoors-1/boxes")
env.set_camera_location([4.0, -3.8, 1.9])
env.set_camera_rotation([1.3, 0.0, 0.68])
env.set_camera_focal_length(34)
env.show(plots=[["robot.pose.yaw", "robot.odometry.yaw"]], overlays=["trails"])
