"""Lights: a robot shows its next action with an LED array and a lamp."""

from morse.builder import *

robot = Morsy()

motion = MotionVW()
robot.append(motion)

leds = LedArray(rows=5, columns=7, pitch=0.06)
leds.translate(x=-0.45, z=1.0)
leds.rotate(z=3.1416)  # faces backward
robot.append(leds)

lamp = Light()
lamp.translate(x=0.5, z=0.8)
robot.append(lamp)

pose = Pose()
robot.append(pose)

robot.add_default_interface("socket")

env = Environment("indoors-1/warehouse")
env.set_camera_location([-3.0, -1.2, 1.8])
env.set_camera_rotation([1.35, 0.0, -1.15])
env.show(follow=robot)
