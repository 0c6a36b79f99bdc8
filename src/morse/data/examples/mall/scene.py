"""Crowds: a robot of a mall fetches a visitor at the entrance, and guides the visitor to a shop."""

from morse.builder import *

WALL, STONE, BORDER, WOOD = (0.86, 0.84, 0.8), (0.5, 0.47, 0.42), (0.2, 0.19, 0.18), (0.5, 0.32, 0.18)
STEEL, GLASS, WATER, LEAF = (0.32, 0.34, 0.36), (0.62, 0.8, 0.85), (0.2, 0.5, 0.62), (0.16, 0.36, 0.14)
#: colours of the signs, the first ones at the entrance; those of the other side follow
SIGNS = [(0.75, 0.12, 0.14), (0.1, 0.36, 0.6), (0.88, 0.55, 0.08), (0.2, 0.45, 0.22)]
SIGNS += [(0.45, 0.2, 0.5), (0.05, 0.5, 0.5), (0.85, 0.36, 0.2), (0.16, 0.18, 0.35)]
LOGOS = [Torus, Sphere, Cone, Cylinder, Cube, Torus, Sphere, Cone]


def shape(kind, name, place, size, color, opacity=1.0):
    """A thing to look at: its middle and its size, m."""
    thing = kind(name)
    thing.scale = tuple(side / 2 for side in size)
    thing.translate(*place)
    thing.color(*color, opacity)
    return thing


def block(name, place, size, color, opacity=1.0, kind=Cube):
    """A box, or another shape, in which nobody can walk."""
    shape(kind, name, place, size, color, opacity).static()


def shop(name, x, side, color, logo):
    """A shop of 10 m on one side of the mall: windows, a door of 2.4 m, a sign, shelves and a counter."""
    block(f"{name} floor", (x, side * 9.5, -0.07), (9.8, 6.9, 0.2), tuple(0.55 + 0.35 * one for one in color))
    block(f"{name} back", (x, side * 13.1, 1.7), (10.2, 0.2, 3.4), WALL)
    for left in (-1, 1):
        block(f"{name} window {left}", (x + left * 3.05, side * 6.0, 1.3), (3.5, 0.06, 2.4), GLASS, 0.3)
        shape(Cube, f"{name} sill {left}", (x + left * 3.05, side * 6.0, 0.1), (3.5, 0.2, 0.2), STEEL)
        shape(Cube, f"{name} post {left}", (x + left * 1.25, side * 6.0, 1.25), (0.1, 0.14, 2.5), STEEL)
        block(f"{name} show {left}", (x + left * 3.2, side * 7.0, 0.25), (2.2, 0.9, 0.5), WALL)
        for item in range(3):
            tint = SIGNS[(item + LOGOS.index(logo) + left) % 8]
            place = (x + left * 3.2 - 0.7 + 0.7 * item, side * 7.0, 0.75)
            shape(logo, f"{name} item {left} {item}", place, (0.4, 0.4, 0.5), tint)
    shape(Cube, f"{name} sign", (x, side * 6.0, 2.95), (9.8, 0.3, 0.9), color)
    mark = shape(logo, f"{name} logo", (x, side * 5.8, 2.95), (0.55, 0.55, 0.55), (0.95, 0.93, 0.88))
    mark.rotate(x=side * 1.5708)
    for row in range(2):
        block(f"{name} shelf {row}", (x - 3 + 4 * row, side * 12.6, 0.8), (3.2, 0.5, 1.6), WOOD)
        for item in range(6):
            tint = SIGNS[(item + 3 * row) % 8]
            place = (x - 4.25 + 0.5 * item + 4 * row, side * 12.55, 1.75)
            shape(Cube, f"{name} goods {row} {item}", place, (0.34, 0.34, 0.3), tint)
    block(f"{name} counter", (x + 3.8, side * 10.2, 0.5), (0.7, 2.2, 1.0), color)


def plant(name, x, y, size):
    """A plant in a pot, of that height in m."""
    block(f"{name} pot", (x, y, 0.3), (0.9, 0.9, 0.6), BORDER, kind=Cylinder)
    shape(Cylinder, f"{name} stem", (x, y, 0.5 * size), (0.12, 0.12, size - 0.6), WOOD)
    for k, (u, v, w, r) in enumerate([(0, 0, 0.9, 1.3), (0.3, 0.2, 0.72, 1.0), (-0.3, 0.1, 0.75, 1.0)]):
        green = tuple(one * (1 + 0.12 * k) for one in LEAF)
        shape(Sphere, f"{name} leaves {k}", (x + u, y + v, w * size), (r, r, 0.9 * r), green)


def bench(name, x, y):
    """A bench without a back; its long side is along X."""
    block(f"{name} seat", (x, y, 0.42), (1.8, 0.5, 0.08), WOOD)
    for left in (-1, 1):
        shape(Cube, f"{name} leg {left}", (x + left * 0.75, y, 0.19), (0.08, 0.44, 0.38), STEEL)


block("ground", (-6.0, 0.0, -0.49), (90.0, 60.0, 1.0), (0.33, 0.34, 0.33))
block("hall", (-8.0, 0.0, -0.07), (56.0, 12.0, 0.2), STONE)
for number in range(9):
    shape(Cube, f"inlay {number}", (-22.0 + 5.0 * number, 0.0, 0.025), (0.3, 12.0, 0.02), BORDER)
for side in (-1, 1):
    shape(Cube, f"border {side}", (-2.0, side * 5.5, 0.03), (44.0, 0.5, 0.02), BORDER)
    for number in range(4):
        k = number + 2 * (side + 1)
        shop(f"shop {k}", -17.0 + 10.0 * number, side, SIGNS[k], LOGOS[k])
    for number in range(5):
        block(f"wall {side} {number}", (-22.0 + 10.0 * number, side * 9.5, 1.7), (0.2, 7.2, 3.4), WALL)
        block(f"pillar {side} {number}", (-22.0 + 10.0 * number, side * 5.95, 1.9), (0.5, 0.5, 3.8), WALL)
    block(f"front {side}", (-24.0, side * 8.0, 1.7), (0.2, 8.0, 3.4), WALL)
    block(f"hedge {side}", (19.0, side * 3.6, 0.45), (0.8, 6.0, 0.9), LEAF)

block("basin", (-2.0, 0.0, 0.25), (3.4, 3.4, 0.5), WALL, kind=Cylinder)
shape(Cylinder, "water", (-2.0, 0.0, 0.26), (3.0, 3.0, 0.5), WATER)
shape(Cylinder, "column", (-2.0, 0.0, 0.7), (0.5, 0.5, 1.0), WALL)
shape(Cylinder, "bowl", (-2.0, 0.0, 1.2), (1.5, 1.5, 0.16), WALL)
shape(Cone, "jet", (-2.0, 0.0, 1.6), (0.5, 0.5, 0.8), (0.75, 0.88, 0.92), 0.6)
for number, x in enumerate((-15.0, -9.0, 5.0, 11.0)):
    plant(f"plant {number}", x, 0.0, 3.0)
    bench(f"bench {number}", x + 2.2, 0.0)

for number, y in enumerate((-2.2, 2.2)):
    door = Door(f"door_{number}", kind="double", width=2.4, height=2.4, automatic=2.5)
    door.translate(-24.0, y, 0.0)
shape(Cube, "mall sign", (-24.0, 0.0, 3.0), (0.3, 12.4, 0.9), BORDER)
for pane in range(3):
    block(f"pane {pane}", (-24.0, 5.2 * (pane - 1), 1.3), (0.08, 1.8, 2.6), GLASS, 0.3)

visitors = Crowd("visitors", 101, groups=0.4, children=0.12, wheelchairs=0.02)
visitors.translate(z=0.03)  # on the floors of the hall and the shops
places = [(-17.0 + 10.0 * (k % 4), -8.6 if k < 4 else 8.6) for k in range(8)]
for k, (x, y) in enumerate(places):
    edge = 1.0 if y > 0 else -1.0
    goals = [places[(k + 3) % 8], places[(k + 6) % 8], (-28.0, 2.2 * edge), (x, y)]
    visitors.start([(x - 4.5, 4.8 * edge), (x + 4.5, 2.2 * edge)], 10, goals=goals, then="repeat", wait=9.0)
visitors.start([(-34, -5), (-27, 5)], 12, over=60, goals=[places[2], places[5]], then="repeat", wait=12.0)
seats = [(x + side * 0.4, 0.0) for x in (-12.8, -6.8, 7.2, 13.2) for side in (-1, 1)]
visitors.start(places=[(x, -0.9) for x, _ in seats], goals=seats, then="sit")
visitors.start(places=[(-21.8, 1.0)], goals=[(-21.8, 1.0)])

robot = Morsy()
robot.translate(-18.0, -0.8, 0.03)
robot.rotate(z=3.14159)
motion = MotionVW()
robot.append(motion)
pose = Pose()
robot.append(pose)
scan = Sick()
scan.translate(x=0.3, z=0.35)
scan.properties(Visible_arc=False, scan_window=80.0, resolution=4.0, laser_range=5.0)
robot.append(scan)
robot.add_default_interface("socket")
visitors.add_service("socket")

env = Environment("empty")
env.set_camera_location([18.3, -0.6, 6.6])
env.set_camera_rotation([1.2, 0.0, 1.5708])
