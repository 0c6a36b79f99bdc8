"""Depth cameras: a Kinect measures the distances of crates."""

from morse.builder import *

robot = Morsy()

kinect = Kinect()  # its name is Kinect, its cameras are rgb and depth
kinect.translate(x=0.5, z=0.4)
robot.append(kinect)

robot.add_default_interface("socket")

for name, y in (("near", 0.6), ("far", -0.9)):
    crate = Cube(name)
    crate.location = (3.0 if name == "near" else 4.5, y, 0.5)
    crate.scale = (0.5, 0.5, 0.5)
    crate.set_color(0.7, 0.5, 0.3)

env = Environment("indoors-1/warehouse")
env.set_camera_location([-2.4, -1.7, 2.2])
env.set_camera_rotation([1.25, 0.0, -1.05])
env.show(images=[kinect], overlays=["frustums"])
