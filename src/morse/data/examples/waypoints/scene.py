"""Asynchronous services: an ATRV drives to three waypoints, and avoids a crate on its way."""

from morse.builder import *

robot = ATRV()

goal = Waypoint()
robot.append(goal)

pose = Pose()
robot.append(pose)

robot.add_default_interface("socket")

crate = PassiveObject("props/crates", "transport_box")
crate.translate(4.0, 0.0, 0.0)

env = Environment("indoors-1/indoor-1")
env.set_camera_location([3.0, -9.0, 7.0])
env.set_camera_rotation([0.9, 0.0, 0.0])
env.set_camera_focal_length(34)
env.show(overlays=["trails"], follow=robot)
