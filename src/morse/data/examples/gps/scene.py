"""Geographic coordinates: a car drives to a position given by longitude and latitude."""

from morse.builder import *

robot = ATRV()
robot.translate(z=0.15)  # the meadow is uneven
robot.rotate(z=0.6)

motion = MotionVW()
robot.append(motion)

gps = GPS()
gps.level("raw")
robot.append(gps)

gyroscope = Gyroscope()
robot.append(gyroscope)

robot.add_default_interface("socket")

env = Environment("land-1/trees")
env.properties(longitude=1.4333, latitude=43.6, altitude=135.0)
env.set_camera_location([6.0, -7.0, 7.0])
env.set_camera_rotation([1.0, 0.0, -0.3])
env.show(plots=["robot.gyroscope.yaw"], select=gps, overlays=["trails"], follow=robot)
