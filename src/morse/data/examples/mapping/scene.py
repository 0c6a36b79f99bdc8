"""Maps: a scanner with a field of view of 360 degrees maps a hall with three boxes."""

from morse.builder import *

robot = Morsy()

teleport = Teleport()
robot.append(teleport)

laser = Hokuyo()
laser.properties(laser_range=25.0, scan_window=360, resolution=1.0)
laser.translate(z=0.6)
robot.append(laser)

robot.add_default_interface("socket")

env = Environment("indoors-1/boxes")
env.set_camera_location([0.0, -18.0, 20.0])
env.set_camera_rotation([0.7, 0.0, 0.0])
env.show(rays=[laser])
