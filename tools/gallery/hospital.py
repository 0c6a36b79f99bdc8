# ruff: noqa: F403, F405
# a corridor of a hospital with rooms, in which people walk both ways and a robot delivers
from morse.builder import *


def wall(name, x, y, length, depth, height=2.6):
    solid = Cube(name)
    solid.scale = (length / 2, depth / 2, height / 2)
    solid.translate(x, y, height / 2)
    solid.color(0.86, 0.88, 0.84)
    solid.static()


floor = Cube("floor")
floor.scale = (18, 6, 0.05)
floor.translate(z=-0.05)
floor.color(0.55, 0.62, 0.64)
floor.static()
for side in (-1, 1):
    for number in range(5):
        # a room of 6 m with a door of 1.2 m in the middle
        middle = -12 + 6 * number
        wall(f"left_{side}_{number}", middle - 1.8, 1.7 * side, 2.4, 0.1)
        wall(f"right_{side}_{number}", middle + 1.8, 1.7 * side, 2.4, 0.1)
        wall(f"between_{side}_{number}", middle + 3.0, 3.6 * side, 0.1, 3.8)
        bed = Cube(f"bed_{side}_{number}")
        bed.scale = (0.45, 1.0, 0.3)
        bed.translate(middle + 1.7, 4.4 * side, 0.3)
        bed.color(0.9, 0.92, 0.95)
        bed.static()
    wall(f"outer_{side}", 0, 5.6 * side, 30, 0.1)

crowd = Crowd("people", 34, groups=0.3, children=0.1, wheelchairs=0.1)
crowd.start([(-14, -1.3), (-4, 1.3)], 14, goals=[(16, 0.6), (-16, 0.6)], then="repeat")
crowd.start([(4, -1.3), (14, 1.3)], 14, goals=[(-16, -0.6), (16, -0.6)], then="repeat")
crowd.start([(-8, 2.6), (-4.5, 5.0)], 3, goals=[(0, -3), (-6, 3)], then="repeat", wait=3)
crowd.start([(-2, -5.0), (1.0, -2.6)], 3, goals=[(6, 3), (0, -3)], then="repeat", wait=3)

robot = Jido("jido")
robot.translate(0, 0, 0.1)
motion = MotionVW("motion")
robot.append(motion)
scan = Sick("scan")
scan.translate(0.3, 0.0, 0.4)
robot.append(scan)

env = Environment("empty")
env.set_camera_location([-9.0, -7.5, 6.5])
env.set_camera_rotation([0.95, 0.0, -0.75])
