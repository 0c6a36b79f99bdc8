"""The world of the tutorial, and a robot with a camera; argument ``rate``, Hz, 0 for no camera."""

import sys

from morse.builder import *

arguments = dict(word.split("=", 1) for word in sys.argv[1:] if "=" in word)
rate = float(arguments.get("rate", 30.0))

robot = ATRV("robot")
if rate:
    camera = VideoCamera("camera")
    camera.translate(x=0.6, z=1.2)
    camera.properties(cam_width=320, cam_height=240, cam_focal=25.0)
    camera.frequency(rate)
    robot.append(camera)

env = Environment("sandbox")
