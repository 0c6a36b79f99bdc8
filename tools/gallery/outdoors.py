# ruff: noqa: F403, F405
from morse.builder import *

car = Hummer("hummer")
car.translate(1.0, 0.0, 1.0)
motion = MotionVW()
car.append(motion)
car.add_default_interface("socket")

drone = Quadrotor("drone")
drone.translate(-2.0, 3.0, 3.5)
drone.add_default_interface("socket")

env = Environment("outdoors")
env.set_camera_location([9.0, -9.0, 5.5])
env.set_camera_rotation([1.18, 0.0, 0.785])
env.set_camera_focal_length(26.0)
