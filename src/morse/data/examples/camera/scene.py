"""Cameras: a robot follows a red ball with its camera."""

from morse.builder import *

robot = ATRV()

motion = MotionVW()
robot.append(motion)

camera = VideoCamera()
camera.translate(x=0.22, z=0.8)  # on the mast
camera.properties(cam_width=64, cam_height=48, cam_focal=25.0)
camera.frequency(10)
robot.append(camera)

pose = Pose()
robot.append(pose)

robot.add_default_interface("socket")

ball = Sphere("ball")
ball.location = (8.0, 2.5, 0.6)
ball.scale = (0.6, 0.6, 0.6)
ball.set_color(0.9, 0.02, 0.02)

env = Environment("indoors-1/boxes")
env.set_camera_location([-4.0, -4.0, 3.5])
env.set_camera_rotation([1.2, 0.0, -0.9])
env.set_camera_focal_length(34)
env.show(images=[camera], overlays=["frustums"], follow=robot)
