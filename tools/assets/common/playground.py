"""The floor of the sandbox, 18 m square, and its surroundings; its rim ends 10.45 m from the centre."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise, product
from typing import TYPE_CHECKING

import numpy as np

from common.morse_code import inlay
from common.parts import Part
from common.shapes import box, ellipsoid, lathe, pill, prism, rectangle, rounded_box, sheet, sphere, tube

if TYPE_CHECKING:
    import bpy

    from common.wood import Carpenter

FLOOR, INNER, OUTER, TOP, BOTTOM = -0.002, 9.0, 10.45, 0.4995, -0.505
TILES = 15
PAINT = 0.0035  # height of painted marks above the floor, against z-fighting


@dataclass
class Paints:
    """The materials of the playground."""

    tiles: tuple[bpy.types.Material, bpy.types.Material]
    marks: dict[str, bpy.types.Material]
    grass: bpy.types.Material
    soil: bpy.types.Material
    deck: bpy.types.Material
    bush: tuple[bpy.types.Material, bpy.types.Material]
    post: bpy.types.Material
    bulb: bpy.types.Material
    wire: bpy.types.Material


def playground(paints: Paints, saw: Carpenter) -> list[Part]:
    return [*floor(paints), *marks(paints), *rim(paints, saw), *garden(paints), *lanterns(paints)]


def floor(paints: Paints) -> list[Part]:
    """Rubber tiles in two shades; each texture is one tile."""
    size = 2 * INNER / TILES
    tile = rectangle(size, size).stretched_over((0, 1))
    places = list(product(range(TILES), repeat=2))
    return [
        tile.moved((i + 0.5) * size - INNER, (j + 0.5) * size - INNER, FLOOR).painted(paints.tiles[(i + j) % 2])
        for i, j in places
    ]


def marks(paints: Paints) -> list[Part]:
    """A round area in the centre with an M, coloured corners, and a greeting in Morse code along each side."""
    z = FLOOR + PAINT
    cream = paints.marks["cream"]
    parts = [
        ring(0.0, 2.05).moved(z=z).painted(paints.marks["teal"]),
        ring(2.17, 2.30).moved(z=z).painted(cream),
        *(sheet(pill(1.35, 0.42, 12)).turned(z=90).moved(0, y, z + PAINT).painted(cream) for y in (-0.85, 0.85)),
    ]
    for number, color in enumerate(("coral", "sky", "leaf", "sun")):
        corner = [ring(0.0, 3.1, 90.0).painted(paints.marks[color]), ring(3.2, 3.32, 90.0).painted(cream)]
        parts += [p.turned(z=180).moved(INNER, INNER, z).turned(z=90 * number) for p in corner]
        greeting = inlay("HELLO ROBOT", 0.105, 0.001, width=1.25)
        parts += [p.moved(0, -8.25, z - 0.001).turned(z=90 * number).painted(paints.marks["teal"]) for p in greeting]
    return parts


def ring(inner: float, outer: float, degrees: float = 360.0) -> Part:
    """A flat ring, or a sector of one from the X axis on, seen from above."""
    steps = max(int(degrees / 5), 1)
    angles = np.radians(np.linspace(0.0, degrees, steps + 1))
    circle = np.column_stack([np.cos(angles), np.sin(angles), np.zeros(steps + 1)])
    vertices = np.concatenate([inner * circle, outer * circle])
    if inner == 0:
        vertices = np.concatenate([np.zeros((1, 3)), outer * circle])
        return Part(vertices, [(0, i + 1, i + 2) for i in range(steps)], smooth=False)
    return Part(vertices, [(i, steps + 1 + i, steps + 2 + i, i + 1) for i in range(steps)], smooth=False)


def rim(paints: Paints, saw: Carpenter) -> list[Part]:
    """A raised bed around the floor: boards inside, a bench along the edge, grass, soil below."""
    parts = []
    for turn in (0, 90, 180, 270):
        side = []
        wall = (TOP - FLOOR) / 3
        for k, number in product(range(3), range(6)):
            width = 2 * INNER / 6
            at = (number + 0.5) * width - INNER
            side.append(
                saw.board(width - 0.01, 0.03, wall - 0.008, paints.deck).moved(
                    at, INNER + 0.015, FLOOR + (k + 0.5) * wall
                )
            )
        bench = np.linspace(-INNER, INNER, 7)
        for a, b in pairwise(bench):
            for row in range(2):
                y = INNER + 0.09 + 0.19 * row
                side.append(
                    saw.board(b - a - 0.012, 0.178, 0.035, paints.deck).moved((a + b) / 2, y - 0.02, TOP - 0.017)
                )
        edge = INNER + 0.36
        grass = sheet([(-edge, edge), (edge, edge), (OUTER, OUTER), (-OUTER, OUTER)]).moved(z=TOP - 0.02)
        side.append(Part(grass.vertices, [grass.faces[0]], smooth=False).mapped(2.5).painted(paints.grass))
        skirt = (
            rectangle(2 * OUTER, TOP - 0.02 - BOTTOM)
            .turned(x=90)
            .turned(z=180)
            .moved(0, OUTER, (TOP - 0.02 + BOTTOM) / 2)
        )
        side.append(skirt.mapped(2.0).painted(paints.soil))
        parts += [p.turned(z=turn) for p in side]
    underside = rectangle(2 * OUTER, 2 * OUTER).turned(x=180).moved(z=BOTTOM)
    return [*parts, underside.mapped(2.0).painted(paints.soil)]


def garden(paints: Paints) -> list[Part]:
    """Bushes and flowers in the corners and between the fences."""
    random = np.random.default_rng(12)
    parts = []
    for sx, sy in product((1, -1), repeat=2):
        for k in range(6):
            along, size = random.uniform(0.35, 1.15), random.uniform(0.14, 0.26)
            x, y = (
                (9.75 + random.uniform(0, 0.5), 8.95 + along)
                if k % 2
                else (8.95 + along, 9.75 + random.uniform(0, 0.5))
            )
            bush = ellipsoid(size, size, size * 0.85, columns=10, rows=6).flat()
            parts.append(
                bush.turned(z=random.uniform(0, 90))
                .moved(sx * x, sy * y, TOP + size * 0.45)
                .painted(paints.bush[k % 2])
            )
    colors = [paints.marks[name] for name in ("coral", "sun", "cream", "sky")]
    for turn, number in product((0, 90, 180, 270), range(14)):
        x, y = random.uniform(-8.8, 8.8), random.uniform(9.5, 9.95)
        stem = box(0.012, 0.012, 0.12).moved(z=0.05).painted(paints.bush[0])
        flower = ellipsoid(0.045, 0.045, 0.03, columns=6, rows=4).flat().moved(z=0.12).painted(colors[number % 4])
        parts += [p.moved(x, y, TOP - 0.02).turned(z=turn) for p in (stem, flower)]
    return parts


def lanterns(paints: Paints) -> list[Part]:
    """A post in each corner, and strings of lights and pennants from one to the next."""
    parts = []
    height, corner = 4.35, 9.95
    pennants = [paints.marks[name] for name in ("coral", "sun", "teal", "cream")]
    for turn in (0, 90, 180, 270):
        post = [
            lathe(
                [
                    (0, TOP - 0.03),
                    (0.13, TOP - 0.03),
                    (0.13, TOP + 0.22),
                    (0.07, TOP + 0.3),
                    (0.055, height),
                    (0, height),
                ],
                16,
            ).painted(paints.post),
            sphere(0.16, 16, 10).moved(z=height + 0.1).painted(paints.bulb),
            lathe([(0, 0), (0.1, 0.0), (0.1, 0.05), (0.07, 0.07), (0, 0.07)], 16)
            .moved(z=height - 0.07)
            .painted(paints.post),
            lathe([(0, 0), (0.15, 0.0), (0.09, 0.05), (0, 0.07)], 16).moved(z=height + 0.225).painted(paints.post),
        ]
        parts += [p.moved(corner, corner).turned(z=turn) for p in post]
        string = sagging(corner, height - 0.15, 1.0, 33)
        cord = [tube(string, 0.012, 4, round_ends=False).painted(paints.wire)]
        for number, (x, _, z) in enumerate(string[1:-1]):
            if number % 4 == 1:
                cord.append(
                    ellipsoid(0.06, 0.06, 0.075, columns=10, rows=6).moved(x, 0, z - 0.085).painted(paints.bulb)
                )
            elif number % 4 == 3:
                flag = prism([(-0.2, 0.0), (0.0, -0.42), (0.2, 0.0)], 0.008).turned(x=90)
                cord.append(flag.moved(x, 0, z - 0.01).painted(pennants[number // 4 % 4]))
        parts += [p.moved(y=corner).turned(z=turn) for p in cord]
    return parts


def sagging(half: float, height: float, sag: float, count: int) -> list[tuple[float, float, float]]:
    return [(x, 0.0, height - sag * (1 - (x / half) ** 2)) for x in np.linspace(-half, half, count)]


def fence(paint: bpy.types.Material) -> list[Part]:
    """A picket fence of 16.3 m along Y, standing on z=0, 0.683 m high."""
    length, height = 16.3, 0.683
    parts = [rounded_box(0.03, length, 0.07, 0.012, 1).moved(-0.025, 0, z) for z in (0.36, 0.56)]
    count = 66
    for y in np.linspace(-length / 2 + 0.06, length / 2 - 0.06, count):
        tip = [(-0.05, 0.0), (0.05, 0.0), (0.05, height - 0.06), (0.0, height), (-0.05, height - 0.06)]
        parts.append(prism(tip, 0.025).turned(x=90, z=90).moved(-0.01, y))
    parts += [
        box(0.08, 0.11, height * 0.93, 0.012).moved(0, y, height * 0.465)
        for y in np.linspace(-length / 2 + 0.06, length / 2 - 0.06, 9)
    ]
    return [p.painted(paint) for p in parts]
