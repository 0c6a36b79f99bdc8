"""The meadow around the playground, with trees, bushes and rocks, and low hills on the horizon."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from common.nature import blades, blob, broadleaf, rock
from common.objects import hidden_cylinder, hidden_shape, solid, twin
from common.parts import Part, bounds
from common.shapes import rectangle, sphere

if TYPE_CHECKING:
    import bpy

    from common.nature import Greens

#: half of the side of the playground, and the extent of the meadow, m
HOLE, REACH = 10.4, 120.0
#: pieces of the meadow: near pieces show a larger part of the texture
RINGS = (HOLE, 32.0, REACH)
#: position, and size relative to the tree that is built
TREES = (
    (-22.0, 17.0, 1.0), (-27.0, 3.5, 1.2), (-17.5, -21.0, 0.9), (19.0, 19.5, 1.1), (25.5, 8.0, 0.85),
    (4.0, 25.0, 1.15), (-8.5, 28.0, 0.95), (27.0, -14.5, 1.1), (12.0, -26.0, 0.9), (-33.0, -12.0, 1.25),
    (36.0, 24.0, 1.3), (16.0, 38.0, 1.1), (-38.0, 26.0, 1.2), (-20.0, 42.0, 1.0), (44.0, -6.0, 1.2),
    (34.0, -36.0, 1.1), (-42.0, -34.0, 1.3), (0.0, -42.0, 1.1),
)  # fmt: skip
#: position and height, m
ROCKS = ((14.5, 12.5, 0.7), (-14.2, 9.0, 0.5), (13.8, -12.0, 0.6), (-15.5, -9.0, 0.8), (-3.0, 15.0, 0.45))
HILLS = 15
STILL = {"physics_type": "STATIC"}
SHOWN = {"physics_type": "NO_COLLISION"}


def meadow(grass: bpy.types.Material, greens: Greens, stone: bpy.types.Material) -> None:
    """Everything outside of the playground, at the height of its floor."""
    solid("Meadow", [part.painted(grass) for part in lawn()], (0, 0, -0.01), **STILL)
    hills(greens)
    trees(greens)
    for number, (x, y, size) in enumerate(ROCKS):
        lump = [rock(stone, 2 * size, 1.5 * size, size, seed=number).moved(z=0.25 * size)]
        solid(f"Rock.{number + 1:03}", lump, (x, y, 0), (0, 0, 1.7 * number), collision="convex", **STILL)
    solid("Tufts", tufts(greens), **SHOWN)


def trees(greens: Greens) -> None:
    """Two kinds of trees in several sizes; a cylinder and a ball are the collision shapes of trunk and crown."""
    kinds = (broadleaf(greens, 5.6, 4.2, 0.16, seed=2), broadleaf(greens, 6.4, 4.0, 0.18, seed=7))
    first: dict[int, bpy.types.Object] = {}
    for number, (x, y, size) in enumerate(TREES):
        name, kind, pose = f"Tree.{number + 1:03}", number % 2, ((x, y, -0.02), (0.0, 0.0, 2.4 * number))
        if kind in first:
            tree = twin(first[kind], name, *pose, **SHOWN)
        else:
            tree = first[kind] = solid(name, kinds[kind], *pose, **SHOWN)
        tree.scale = (size, size, size)
        low, high = bounds(kinds[kind])
        trunk, crown = 0.4 * size * high[2], 0.3 * size * (high[2] - low[2])
        hidden_cylinder(f"{name}_bb1", 0.17 * size, trunk, (x, y, trunk / 2), **STILL)
        ball = [sphere(crown, 16, 10)]
        hidden_shape(f"{name}_bb2", ball, (x, y, 0.7 * size * high[2]), collision="sphere", **STILL)


def lawn() -> list[Part]:
    """Flat strips around the playground, with a continuous texture."""
    strips = []
    for near, far in pairwise(RINGS):
        wide = (far - near, 2 * far)
        strips += [rectangle(*wide).moved(side * (near + far) / 2, 0) for side in (-1, 1)]
        strips += [rectangle(2 * near, far - near).moved(0, side * (near + far) / 2) for side in (-1, 1)]
    return [strip.mapped(9.0) for strip in strips]


def hills(greens: Greens) -> None:
    """A ring of domes, each of them convex."""
    random = np.random.default_rng(17)
    for number in range(HILLS):
        angle = 2 * math.pi * number / HILLS + random.uniform(-0.12, 0.12)
        away, wide, high = random.uniform(86, 100), random.uniform(24, 34), random.uniform(5.0, 10.0)
        place = (away * math.cos(angle), away * math.sin(angle), -0.5)
        paint = greens.leaves[1 + number % 2]
        shape = dome(wide, wide * random.uniform(0.6, 0.9), high).turned(z=math.degrees(angle) + 90).painted(paint)
        solid(f"Hill.{number + 1:03}", [shape], place, collision="convex", **STILL)


def dome(x: float, y: float, z: float, columns: int = 28, rows: int = 7) -> Part:
    """The upper half of an ellipsoid with these semi-axes."""
    turns = np.arange(columns) * 2 * np.pi / columns
    rings = [
        np.column_stack([x * np.cos(a) * np.cos(turns), y * np.cos(a) * np.sin(turns), np.full(columns, z * np.sin(a))])
        for a in np.linspace(0.0, 0.5 * np.pi, rows + 1)[:-1]
    ]
    vertices = np.concatenate([*rings, [[0.0, 0.0, z]]])
    top = len(vertices) - 1
    faces: list[tuple[int, ...]] = [
        (i * columns + j, i * columns + (j + 1) % columns, (i + 1) * columns + (j + 1) % columns, (i + 1) * columns + j)
        for i in range(rows - 1)
        for j in range(columns)
    ]
    faces += [((rows - 1) * columns + j, (rows - 1) * columns + (j + 1) % columns, top) for j in range(columns)]
    return Part(vertices, faces)


def tufts(greens: Greens) -> list[Part]:
    """Grass, bushes and flowers near the playground."""
    random = np.random.default_rng(23)
    parts = []
    for number in range(90):
        x, y = random.uniform(-24, 24, 2)
        if max(abs(x), abs(y)) < HOLE + 0.8:
            continue
        if number % 5:
            grown = blades(greens, 0.3, 0.34, 7, number)
        else:
            size = random.uniform(0.3, 0.6)
            grown = [blob(size, number, columns=9, rows=6).moved(z=size * 0.5).painted(greens.leaves[number % 3])]
        parts += [part.moved(x, y) for part in grown]
    return parts
