"""Under water: thrust against drag. The boat reaches the speed at which both are equal."""

from morse.builder import *

robot = Submarine()
robot.translate(z=0.0)

engine = ForceTorque()
robot.append(engine)

drag = Drag()
drag.properties(DragCoeffX=8.0, DragCoeffY=40.0, DragCoeffZ=40.0)
robot.append(drag)

velocity = Velocity()
robot.append(velocity)

robot.add_default_interface("socket")

env = Environment("water-1/deep_water")
env.set_gravity(0.001)  # the boat neither sinks nor rises
env.set_camera_location([2.0, -9.0, 4.0])
env.set_camera_rotation([1.2, 0.0, 0.15])
env.show(plots=["robot.velocity.linear_velocity"], follow=robot)
