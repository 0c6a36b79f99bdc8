"""Grippers: a robot grasps a box, carries it to another place, and releases it."""

from morse.builder import *

robot = Morsy()

motion = MotionVW()
robot.append(motion)

gripper = Gripper()
gripper.translate(x=0.6, z=0.15)
gripper.rotate(y=1.5708)  # the fingers point forward
gripper.properties(Distance=1.0)
robot.append(gripper)

pose = Pose()
robot.append(pose)

robot.add_default_interface("socket")

box = PassiveObject("props/objects", "BlackVideotape")
box.name = "tape"
box.setgraspable()
box.translate(2.0, 0.0, 0.05)

env = Environment("indoors-1/indoor-1")
env.set_camera_location([3.8, -2.6, 1.5])
env.set_camera_rotation([1.29, 0.0, 0.65])
env.show(plots=["robot.pose.x"], overlays=["trails"])
