"""Inertial sensors: the heading from a gyroscope with the errors of a data sheet drifts."""

from morse.builder import *

robot = ATRV()

motion = MotionVW()
robot.append(motion)

imu = BMI088()
robot.append(imu)

pose = Pose()
robot.append(pose)

robot.add_default_interface("socket")

env = Environment("indoors-1/boxes")
env.set_seed(4)
env.set_camera_location([3.0, -7.0, 6.0])
env.set_camera_rotation([0.9, 0.0, 0.3])
env.set_camera_focal_length(34)
env.show(plots=["robot.imu.angular_velocity"], overlays=["trails"], follow=robot)
