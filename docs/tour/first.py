"""The scene that `morse create` writes, for the tutorial: the robot drives onto the balls."""

from morse.builder import *

robot = Morsy()
robot.translate(1.0, 0.0, 0.0)
robot.rotate(0.0, 0.0, 3.5)

motion = MotionVW()
robot.append(motion)

pose = Pose()
robot.append(pose)

env = Environment("sandbox")
env.set_camera_location([-18.0, -6.7, 10.8])
env.set_camera_rotation([1.09, 0, -1.14])
env.show(overlays=["trails"], layout=[])
