"""Many robots: nine robots start at random positions and form a circle."""

from morse.builder import *

for number in range(9):
    robot = FakeRobot("bot%d" % number)
    # the same positions in every run
    robot.translate((number * 37) % 11 - 5.0, (number * 53) % 13 - 6.0, 0.3)
    body = Cylinder("body%d" % number)
    body.scale = (0.25, 0.25, 0.3)
    body.set_color(0.2 + 0.08 * number, 0.5, 0.9 - 0.08 * number)
    robot.append(body)
    motion = MotionXYW("motion")
    motion.properties(ControlType="Position")
    robot.append(motion)
    pose = Pose("pose")
    robot.append(pose)
    robot.add_default_interface("socket")

env = Environment("land-1/trees")
env.set_camera_location([0.0, -11.0, 10.0])
env.set_camera_rotation([0.85, 0.0, 0.0])
env.set_camera_focal_length(34)
env.show(overlays=["trails", "names"])
