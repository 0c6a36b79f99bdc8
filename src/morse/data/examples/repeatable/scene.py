"""Repeatability: bit-identical runs, step by step."""

from morse.builder import *

robot = Pioneer3DX()

motion = MotionVWDiff()
robot.append(motion)

pose = Pose()
pose.noise(0.05, field="x")
robot.append(pose)

robot.add_default_interface("socket")

env = Environment("sandbox")
env.set_camera_location([3.6, -4.6, 3.2])
env.set_camera_rotation([1.08, 0.0, 0.55])
env.show(plots=["robot.pose.x"], overlays=["trails"], follow=robot)
