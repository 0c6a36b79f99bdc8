"""Real sensors: the same robot with an ideal pose and a pose with noise, a delay and another frame."""

from morse.builder import *

robot = ATRV()
robot.translate(z=0.15)  # the meadow is uneven

motion = MotionVW()
robot.append(motion)

truth = Pose()
robot.append(truth)

measured = Pose()
measured.noise(0.1, field="x")
measured.noise(0.1, field="y")
robot.append(measured)

sea = Pose()
sea.alter("NED")
robot.append(sea)

robot.add_default_interface("socket")

env = Environment("land-1/trees")
env.set_seed(11)
env.set_camera_location([4.0, -6.0, 5.0])
env.set_camera_rotation([0.95, 0.0, 0.2])
env.set_camera_focal_length(34)
env.show(plots=[["robot.truth.x", "robot.measured.x"]], overlays=["trails"], follow=robot)
