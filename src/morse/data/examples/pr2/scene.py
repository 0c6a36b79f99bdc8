"""Service robots: a PR2 rises, spreads its arms, looks around, and drives sideways."""

from morse.builder import *

pr2 = LocalizedPR2()
pr2.add_interface("socket")
pr2.add_service("socket")  # its own services: set_torso, ...

env = Environment("indoors-1/indoor-1")
env.set_camera_location([3.2, -2.6, 2.0])
env.set_camera_rotation([1.25, 0.0, 0.9])
env.set_camera_focal_length(28)
