"""The world of the tutorial, and a robot with cameras.

Arguments: ``rate``, Hz, 0 for no camera; ``cameras``, number of them, each a quarter of a turn further; ``delay`` of
the cameras, s; ``others``, number of robots with laser scanners; ``turning``, 1 for a robot that a velocity actuator
moves.
"""

import math
import sys

from morse.builder import *

arguments = dict(word.split("=", 1) for word in sys.argv[1:] if "=" in word)
rate = float(arguments.get("rate", 30.0))

robot = ATRV("robot")
if int(arguments.get("turning", 0)):
    robot.append(MotionVW("motion"))
for number in range(int(arguments.get("cameras", 1)) if rate else 0):
    camera = VideoCamera(f"camera{number or ''}")
    camera.translate(x=0.6, z=1.2)
    camera.rotate(x=math.pi / 2 * number)
    camera.properties(cam_width=320, cam_height=240, cam_focal=25.0)
    camera.frequency(rate)
    camera.delay(float(arguments.get("delay", 0.0)))
    robot.append(camera)

for number in range(int(arguments.get("others", 0))):
    other = ATRV(f"other{number}")
    other.translate(-4.0 + 1.5 * (number % 6), 4.0 + 1.5 * (number // 6), 0.2)
    other.append(Sick())

env = Environment("sandbox")
