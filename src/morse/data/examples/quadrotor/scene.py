"""Aircraft: a quadrotor flies a circuit, and lands."""

from morse.builder import *

robot = Quadrotor()
robot.translate(z=0.2)

pilot = RotorcraftWaypoint()
robot.append(pilot)

pose = Pose()
robot.append(pose)

robot.add_default_interface("socket")

env = Environment("outdoors")
env.set_camera_location([6.0, -4.0, 4.5])
env.set_camera_rotation([1.3, 0.0, 0.785])
env.show(plots=["robot.pose.z"], overlays=["trails"], follow=robot)
