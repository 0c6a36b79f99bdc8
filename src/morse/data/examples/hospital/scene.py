"""Lifts: a robot of a hospital takes the lift, with visitors, and delivers on the upper floor."""

from morse.builder import *

WALL, FLOOR, DOOR_MARK = (0.82, 0.84, 0.82), (0.55, 0.62, 0.6), (0.2, 0.45, 0.65)
STEEL, SHEET, MARK = (0.5, 0.52, 0.55), (0.9, 0.92, 0.95), (0.9, 0.75, 0.1)
UPPER = 3.5


def block(name, place, size, color):
    """A box that stands still: its middle and its size, m."""
    box = Cube(name)
    box.scale = tuple(side / 2 for side in size)
    box.translate(*place)
    box.set_color(*color)
    box.static()


block("upper floor", (8.11, 0.0, UPPER - 0.1), (16.2, 7.0, 0.2), FLOOR)
for floor, height in enumerate((0.0, UPPER)):
    block(f"north {floor}", (7.0, 3.6, height + 1.2), (18.4, 0.2, 2.4), WALL)
    block(f"east {floor}", (16.1, 0.0, height + 1.2), (0.2, 7.0, 2.4), WALL)
    for side in (-1, 1):
        block(f"beside the lift {floor} {side}", (-0.1, side * 2.3, height + 1.2), (0.2, 2.2, 2.4), DOOR_MARK)
    for bed in range(3):
        x = 7.0 + 3.4 * bed
        block(f"bed {floor} {bed}", (x, 2.5, height + 0.25), (1.0, 2.0, 0.5), STEEL)
        block(f"sheet {floor} {bed}", (x, 2.4, height + 0.54), (0.96, 1.7, 0.08), SHEET)
    for post in range(3):
        block(f"rail {floor} {post}", (2.7 + 5.4 * post, -3.45, height + 1.0), (5.4, 0.06, 0.06), STEEL)
        block(f"post {floor} {post}", (5.4 * post, -3.45, height + 0.5), (0.06, 0.06, 1.0), STEEL)
block("target", (7.0, 0.0, UPPER + 0.002), (1.2, 1.2, 0.004), MARK)

lift = Lift("lift", levels=(0.0, UPPER), size=(2.4, 2.4), capacity=4, hold=4.0)
lift.translate(x=-1.3)

visitors = Crowd("visitors", 6, floors=(0.0, UPPER))
visitors.start([(9, -2.5), (14, 1.0)], 3, goals=[(12, -1, UPPER), (12, -1)], then="repeat", wait=10.0)
visitors.start([(12, -2.5, UPPER), (15, 1.0, UPPER)], 3, goals=[(10, -1), (10, -1, UPPER)], then="repeat", wait=10.0)

robot = Morsy()
robot.translate(4.0, -1.0, 0.0)
motion = MotionVW()
robot.append(motion)
pose = Pose()
robot.append(pose)
robot.add_default_interface("socket")
lift.add_service("socket")

env = Environment("empty")
env.set_camera_location([8.5, -13.0, 7.0])
env.set_camera_rotation([1.15, 0.0, 0.12])
