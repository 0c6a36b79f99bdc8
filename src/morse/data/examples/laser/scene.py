"""Laser scanners: a robot explores a hall and avoids obstacles."""

from morse.builder import *

robot = ATRV()
robot.rotate(z=1.2)

motion = MotionVW()
robot.append(motion)

# the arrow keys of the live view drive, too
keyboard = Keyboard()
keyboard.properties(ControlType="Position")
robot.append(keyboard)

laser = Hokuyo()
laser.translate(x=0.4, z=0.4)
laser.properties(laser_range=8.0, scan_window=180, resolution=2.0)
robot.append(laser)

bumper = Bumper()
bumper.translate(x=0.2, z=0.4)
robot.append(bumper)

pose = Pose()
robot.append(pose)

robot.add_default_interface("socket")

env = Environment("indoors-1/boxes")
env.set_camera_location([0.0, -8.0, 9.0])
env.set_camera_rotation([0.7, 0.0, 0.0])
env.show(rays=[laser], overlays=["trails"], follow=robot)
