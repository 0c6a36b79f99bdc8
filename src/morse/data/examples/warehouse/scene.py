"""Forklifts: a truck fetches a pallet from a rack, and brings it to a conveyor."""

from morse.builder import *

STEEL, BEAM, WALL = (0.2, 0.32, 0.55), (0.85, 0.45, 0.1), (0.75, 0.76, 0.74)


def block(name, place, size, color):
    """A box that stands still: its middle and its size, m."""
    box = Cube(name)
    box.scale = tuple(side / 2 for side in size)
    box.translate(*place)
    box.set_color(*color)
    box.static()


def goods(name, x, y, z):
    """A pallet with three boxes on it: its place, m."""
    pallet = PassiveObject("props/pallet")
    pallet.name = name
    pallet.translate(x, y, z)
    for number, (ahead, aside) in enumerate([(-0.3, 0.2), (-0.3, -0.2), (0.25, 0.0)]):
        box = Cube(f"{name} box {number}")
        box.scale = (0.22, 0.18, 0.2)
        box.set_color(0.6, 0.42, 0.22 + 0.05 * number)
        box.translate(x + ahead, y + aside, z + 0.345)
        box.set_rigid_body()
        box.set_mass(80.0)


block("wall north", (2.0, 5.0, 2.0), (16.0, 0.2, 4.0), WALL)
block("wall east", (8.0, -1.0, 2.0), (0.2, 12.0, 4.0), WALL)
for row in range(4):
    for side in range(2):
        block(f"post {row} {side}", (5.4 + 0.8 * side, 1.5 * row - 1.5, 1.3), (0.08, 0.1, 2.6), STEEL)
for level in range(2):
    for side in range(2):
        block(f"beam {level} {side}", (5.4 + 0.8 * side, 0.75, 1.04 + 1.2 * level), (0.08, 4.4, 0.12), BEAM)
goods("pallet", 5.8, 0.75, 1.101)
goods("second pallet", 5.8, 2.25, 1.101)
goods("third pallet", 5.8, -0.75, 2.301)

belt = Conveyor("belt", length=5.0, width=1.0, height=0.5, speed=0.4, running=False)
belt.translate(x=0.5, y=-2.5)
belt.rotate(z=-1.5708)
belt.add_service("socket")

truck = Forklift()
truck.translate(x=0.0, y=0.75)
pose = Pose()
truck.append(pose)
truck.add_default_interface("socket")
truck.add_service("socket")

env = Environment("empty")
env.set_camera_location([-4.5, -7.5, 4.5])
env.set_camera_rotation([1.18, 0.0, -0.6])
