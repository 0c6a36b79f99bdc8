"""Other objects of a flat or an office in any size.

Width along X, depth along Y with the front towards -Y; they stand on z=0, their middle over the origin.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from common.parts import Part, mirrored_x
from common.shapes import box, cylinder, lathe, tube

if TYPE_CHECKING:
    import bpy

    from common.stock import Stock


def whiteboard(stock: Stock, w: float, d: float, h: float, drawing: bpy.types.Material) -> list[Part]:
    """On wheels; the drawing is on the side of -Y."""
    face, level = h * 0.6, h * 0.69
    sheet = box(w * 0.93, 0.004, face * 0.94).stretched_over((0, 2)).moved(0, -0.014, level).painted(drawing)
    parts = [
        stock.block(w * 0.97, 0.024, face, "steel", 0.008).moved(z=level),
        sheet,
        box(w * 0.5, 0.06, 0.02, 0.005).moved(0, -0.035, level - face / 2).painted(stock["steel"]),
    ]
    side = [
        tube([(w * 0.485, 0, h), (w * 0.485, 0, 0.1)], 0.02, 10).painted(stock["steel"]),
        tube([(w * 0.485, -d * 0.45, 0.08), (w * 0.485, d * 0.45, 0.08)], 0.02, 10).painted(stock["steel"]),
        *(
            cylinder(0.035, 0.03, 0.006, 16).turned(y=90).moved(w * 0.485, y * d * 0.44, 0.036).painted(stock["black"])
            for y in (1, -1)
        ),
    ]
    pens = [
        tube([(x, -0.045, level - face / 2 + 0.016), (x + 0.1, -0.045, level - face / 2 + 0.016)], 0.008, 8).painted(
            stock[c]
        )
        for x, c in ((-0.2, "red"), (-0.05, "leaf"), (0.1, "navy"))
    ]
    return [*parts, *mirrored_x(side), *pens]


def plant(stock: Stock, w: float, h: float, leaves: int = 26, seed: int = 1) -> list[Part]:
    """Leaves on bent stems in a clay pot."""
    pot = h * 0.22
    r = w * 0.26
    parts = [
        lathe(
            [
                (0, 0),
                (r * 0.75, 0.0),
                (r, pot * 0.85),
                (r * 1.08, pot * 0.85),
                (r * 1.08, pot),
                (r * 0.9, pot),
                (r * 0.88, pot * 0.9),
                (0, pot * 0.9),
            ],
            24,
        ).painted(stock["clay"])
    ]
    random = np.random.default_rng(seed)
    for k in range(leaves):
        angle, lean, long_ = 137.5 * k, random.uniform(0.15, 1.0), random.uniform(0.55, 1.0)
        reach, top = w * 0.5 * lean * 0.8, pot + (h - pot) * long_ * (1 - 0.35 * lean)
        stem = [(0.01, 0, pot * 0.85), (reach * 0.35, 0, pot + (top - pot) * 0.65), (reach * 0.8, 0, top)]
        parts.append(tube(stem, [0.006, 0.005, 0.003], 5, round_ends=False).turned(z=angle).painted(stock["leaf"]))
        size = w * 0.16
        blade = (
            lathe([(0, -0.01), (1.0, 0.0), (0, 0.012)], 8)
            .scaled(size, size * 0.45, size)
            .turned(y=random.uniform(10, 50))
        )
        parts.append(
            blade.moved(reach * 0.8 + size * 0.5, 0, top)
            .turned(z=angle)
            .painted(stock["light leaf" if k % 3 == 0 else "leaf"])
        )
    return parts


def floor_lamp(stock: Stock, w: float, h: float, shade: bpy.types.Material) -> list[Part]:
    r = w / 2
    return [
        cylinder(r * 0.9, 0.02, 0.005, 28).moved(z=0.01).painted(stock["black"]),
        tube([(0, 0, 0.02), (0, 0, h * 0.75)], 0.012, 10).painted(stock["black"]),
        lathe([(0, h * 0.72), (r, h * 0.72), (r * 0.8, h), (0, h)], 28).painted(shade),
    ]


def radiator(stock: Stock, w: float, d: float, h: float) -> list[Part]:
    count = max(int(w / 0.09), 4)
    pitch = w * 0.96 / count
    parts = [
        stock.block(pitch * 0.7, d * 0.9, h, "white", 0.02).moved((k + 0.5) * pitch - w * 0.48, 0, h / 2)
        for k in range(count)
    ]
    parts += [tube([(-w / 2, 0, z), (w / 2, 0, z)], d * 0.16, 8).painted(stock["white"]) for z in (h * 0.12, h * 0.88)]
    return [
        *parts,
        cylinder(d * 0.3, 0.05, 0.01, 16).turned(y=90).moved(w / 2 - 0.02, 0, h * 0.88).painted(stock["coral"]),
    ]


def bottle(stock: Stock, width: float, height: float, glass: str = "leaf") -> list[Part]:
    r, h = width / 2, height
    body = [
        (0, 0),
        (r * 0.9, 0.0),
        (r, h * 0.03),
        (r, h * 0.55),
        (r * 0.8, h * 0.66),
        (r * 0.35, h * 0.76),
        (r * 0.32, h * 0.92),
    ]
    return [
        lathe([*body, (0, h * 0.92)], 28).painted(stock[glass]),
        lathe([(0, h * 0.9), (r * 0.38, h * 0.9), (r * 0.38, h), (0, h)], 20).painted(stock["red"]),
        lathe([(r * 1.0, h * 0.18), (r * 1.012, h * 0.19), (r * 1.012, h * 0.46), (r * 1.0, h * 0.47)], 28).painted(
            stock["paper"]
        ),
    ]
