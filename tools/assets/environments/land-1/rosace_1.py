"""A world for search and fire fighting: quarters of a town, old trees, a way point and a fire."""

from __future__ import annotations

import math

from common.colors import CORAL, WHITE
from common.land import block, ground
from common.materials import material
from common.nature import Greens, crown_of, trunk_of
from common.objects import exact, viewpoint
from common.parts import bounds
from common.shapes import cylinder, ellipsoid, lathe
from common.sky import sky, sunshine
from common.town import Masonry

#: name, position, size and centre of the bounding box, angle about Z
BLOCKS = (
    ("City.1", (35.4, -44.1, 15.7), (37.4, 43.2, 31.2), (0, 0, 0), 0.0),
    ("City.2", (-50.6, 0.698, 3.59), (47.6, 15.4, 12.6), (15.2, 2.14, 2.75), 0.0),
    ("City.3", (39.1, 36.9, 4.1), (21.6, 30.3, 11.0), (-5.95, 2.72, 1.33), -1.11),
    ("City.4", (-7.22, 41.3, 4.48), (11.7, 23.9, 8.75), (-0.726, -0.847, 0.647), -0.388),
)
#: position, bounding boxes of the trunk and of the leaves: size, centre
TREES = (
    ((-8.73, -9.79, 0.24), ((3.98, 3.7, 8.08), (-0.096, -0.121, 4.03)), ((5.54, 5.21, 6.78), (-0.114, -0.088, 4.29))),
    ((0.798, 6.47, 0.039), ((2.98, 2.77, 6.06), (-0.072, -0.091, 3.02)), ((4.15, 3.91, 5.09), (-0.086, -0.066, 3.22))),
    ((-39.1, 10.8, -0.175), ((5.67, 5.47, 12.2), (-0.127, -0.152, 6.08)), ((6.54, 6.42, 8.95), (-0.132, -0.155, 6.36))),
)


def build() -> None:
    sky("#c3d4de")
    sunshine(3.0, (0.7, 0.3, 0.6))
    ground([(-8.7, -9.8, 0.2), (0, 0, 0), (10, -12, 0), (0.8, 6.5, 0.04)], dip=-0.016, rise=1.114, seed=7)
    masonry = Masonry.make()
    for number, (name, at, size, centre, turn) in enumerate(BLOCKS):
        block(name, at, size, centre, turn, number + 11, masonry)
    trees()
    signs()
    viewpoint((14.0, -16.0, 9.0), (0.0, 2.0, 0.5))


def trees() -> None:
    greens = Greens.make()
    for number, (at, trunk, leaves) in enumerate(TREES):
        suffix = f".{number:03}" if number else ""
        height, width = trunk[0][2], leaves[0][0]
        wood = trunk_of(greens, height * 1.15, width, height * 0.035, number + 31)
        root = exact(f"trunk{suffix}", wood, *trunk, at, physics_type="STATIC", collision="box")
        low, high = bounds(crown := crown_of(greens, height, width, number + 31))
        crown = [p.moved(*-(low + high) / 2) for p in crown]
        exact(f"leaves{suffix}", crown, *leaves, at, parent=root, physics_type="NO_COLLISION")


def signs() -> None:
    red, white = material("Signal", CORAL, 0.5), material("Signal White", WHITE, 0.5)
    pole = [
        cylinder(0.05, 3.4, columns=12).moved(z=1.7).painted(white),
        lathe([(0, 3.2), (0.21, 3.3), (0, 4.0)], 16).painted(red),
    ]
    pole += [cylinder(0.06, 0.4, columns=12).moved(z=z).painted(red) for z in (0.6, 1.4, 2.2)]
    pole.append(cylinder(0.21, 0.06, 0.02, 20).moved(z=0.03).painted(red))
    exact("WayPoint", pole, (0.42, 0.42, 4), (0, 0, 2), (70, -35, 0), physics_type="NO_COLLISION")
    glow = material("Fire", "#ff6a1f", 0.8, glow=1.5)
    dome = ellipsoid(25, 25, 1.875, columns=40, rows=10).moved(z=-1.875).painted(glow)
    burning = {"Fire": True, "Fire_Radius": 25.0, "Fire_Growth": 0.0002, "physics_type": "NO_COLLISION"}
    exact("Fire_Sphere", [dome], (50, 50, 3.75), (0, 0, -1.88), (60, 0, 0), (-math.pi, 0, -math.pi), **burning)
