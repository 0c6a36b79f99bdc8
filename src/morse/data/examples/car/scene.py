"""Cars: a Hummer with steering wheel, engine and brakes."""

from morse.builder import *

robot = Hummer()
robot.translate(z=1.3)

pedals = SteerForce()
robot.append(pedals)

pose = Pose()
robot.append(pose)

velocity = Velocity()
robot.append(velocity)

robot.add_default_interface("socket")

env = Environment("land-1/trees")
env.set_camera_location([10.0, -14.0, 8.0])
env.set_camera_rotation([1.1, 0.0, 0.6])
env.show(plots=["robot.velocity.linear_velocity"], follow=robot)
