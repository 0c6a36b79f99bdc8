# ruff: noqa: F403, F405
from morse.builder import *

for i in range(100):
    robot = (Pioneer3DX, SegwayRMP400, B21)[i % 3](f"robot{i}")
    robot.translate((i % 10) * 2.2 - 10.0, (i // 10) * 2.2 - 10.0, 0.1)
    robot.rotate(0.0, 0.0, i * 0.7)
    motion = MotionVW("motion")
    motion.properties(ControlType="Velocity")
    robot.append(motion)
    robot.add_default_interface("socket")

env = Environment("empty")
env.set_camera_location([16.0, -16.0, 12.0])
env.set_camera_rotation([1.0, 0.0, 0.785])
env.set_camera_focal_length(26.0)
