"""Tables and seats in any size.

Width along X, depth along Y with the front towards -Y; they stand on z=0, their middle over the origin.
"""

from __future__ import annotations

from itertools import product
from typing import TYPE_CHECKING

import numpy as np

from common.parts import Part, mirrored_x
from common.shapes import box, cylinder, tube

if TYPE_CHECKING:
    from common.stock import Stock


def table(
    stock: Stock, w: float, d: float, h: float, wood: str = "birch", legs: str = "birch", shelf: bool = False
) -> list[Part]:
    top, leg = 0.035 * (h / 0.75), 0.05 * (h / 0.75)
    parts = [stock.board(w, d, top, wood).moved(z=h - top / 2)]
    parts += [
        stock.board(leg, leg, h - top, legs).moved(x * (w - leg) / 2, y * (d - leg) / 2, (h - top) / 2)
        for x, y in product((1, -1), repeat=2)
    ]
    rail = h * 0.08
    parts += [
        stock.board(w - 2 * leg, top * 0.6, rail, legs).moved(0, y * (d / 2 - leg / 2), h - top - rail / 2)
        for y in (1, -1)
    ]
    if shelf:
        parts.append(stock.board(w - leg, d - leg, top * 0.7, wood).moved(z=h * 0.25))
    return parts


def desk(stock: Stock, w: float, d: float, h: float, wood: str = "oak", drawers: int = 3) -> list[Part]:
    """A table with drawers under its left end (+X) and a panel at the back."""
    top, panel = 0.04 * (h / 0.73), 0.03
    parts = [stock.board(w, d, top, wood).moved(z=h - top / 2)]
    parts += [stock.board(panel, d * 0.92, h - top, wood).moved(x * (w / 2 - panel), 0, (h - top) / 2) for x in (1, -1)]
    parts.append(stock.board(w * 0.92, panel * 0.8, h * 0.5, wood).moved(0, d * 0.42, h * 0.65))
    if drawers:
        width, height = w * 0.27, (h - top) * 0.85
        x = w / 2 - panel * 1.6 - width / 2
        parts.append(stock.block(width, d * 0.84, height, "white", 0.008).moved(x, 0, h - top - height / 2))
        for k in range(drawers):
            z = h - top - height * (k + 0.5) / drawers
            parts.append(
                stock.block(width * 0.94, 0.02, height / drawers * 0.92, "white", 0.006).moved(x, -d * 0.42 - 0.01, z)
            )
            parts.append(
                tube([(x - 0.05, -d * 0.42 - 0.03, z), (x + 0.05, -d * 0.42 - 0.03, z)], 0.007, 8).painted(
                    stock["steel"]
                )
            )
    return parts


def chair(stock: Stock, w: float, d: float, h: float, wood: str = "oak", seat: str = "") -> list[Part]:
    """Four legs, and a back at +Y."""
    leg, level = 0.035 * (w / 0.42), h * 0.5
    parts = [stock.board(leg, leg, level, wood).moved(x * (w - leg) / 2, -(d - leg) / 2, level / 2) for x in (1, -1)]
    parts += [stock.board(leg, leg, h, wood).moved(x * (w - leg) / 2, (d - leg) / 2, h / 2) for x in (1, -1)]
    cushion = stock.block(w, d * 0.97, 0.05, seat, 0.02) if seat else stock.board(w, d * 0.97, 0.03, wood)
    parts.append(cushion.moved(z=level))
    parts += [
        stock.board(w - leg, leg * 0.6, h * 0.09, wood).moved(0, (d - leg) / 2, h * z) for z in (0.66, 0.80, 0.94)
    ]
    parts += [
        stock.board(leg * 0.6, d - leg, leg * 0.8, wood).moved(x * (w - leg) / 2, 0, level * 0.4) for x in (1, -1)
    ]
    return parts


def rolling_chair(stock: Stock, w: float, d: float, h: float, cloth: str = "navy") -> list[Part]:
    foot = min(w, d) / 2
    parts = []
    for angle in np.arange(5) * 72.0:
        parts.append(
            tube([(0.02, 0, 0.11), (foot * 0.85, 0, 0.075)], [0.022, 0.016], 8)
            .turned(z=angle + 18)
            .painted(stock["black"])
        )
        parts.append(
            cylinder(0.03, 0.03, 0.006, 14)
            .turned(x=90)
            .moved(foot * 0.85, 0, 0.03)
            .turned(z=angle + 18)
            .painted(stock["black"])
        )
    parts += [
        cylinder(0.028, h * 0.3, 0.004, 16).moved(z=0.1 + h * 0.15).painted(stock["steel"]),
        stock.block(w * 0.82, d * 0.75, 0.08, cloth, 0.035).moved(0, -d * 0.05, h * 0.5),
        stock.block(w * 0.72, 0.07, h * 0.40, cloth, 0.032).turned(x=6).moved(0, d * 0.36, h * 0.79),
        tube([(0, 0, h * 0.46), (0, d * 0.38, h * 0.48), (0, d * 0.42, h * 0.7)], 0.018, 8).painted(stock["black"]),
    ]
    arm = tube(
        [(w * 0.42, d * 0.05, h * 0.5), (w * 0.46, d * 0.05, h * 0.66), (w * 0.46, -d * 0.18, h * 0.67)], 0.018, 8
    )
    return [*parts, *mirrored_x([arm.painted(stock["black"])])]


def easy_chair(stock: Stock, w: float, d: float, h: float, wood: str = "birch", cloth: str = "teal") -> list[Part]:
    """A bent frame with a long cushion."""
    side = tube(
        [
            (w * 0.46, d * 0.38, 0.02),
            (w * 0.46, -d * 0.42, 0.02),
            (w * 0.46, -d * 0.46, h * 0.3),
            (w * 0.46, -d * 0.4, h * 0.52),
            (w * 0.46, d * 0.2, h * 0.48),
        ],
        0.024,
        8,
    )
    seat = stock.block(w * 0.84, d * 0.62, 0.09, cloth, 0.04).turned(x=-10).moved(0, -d * 0.12, h * 0.40)
    back = stock.block(w * 0.84, 0.09, h * 0.62, cloth, 0.04).turned(x=-20).moved(0, d * 0.3, h * 0.68)
    rails = [
        tube([(-w * 0.46, y, z), (w * 0.46, y, z)], 0.018, 8).painted(stock[wood])
        for y, z in ((d * 0.15, h * 0.36), (-d * 0.4, h * 0.38))
    ]
    return [*mirrored_x([side.painted(stock[wood])]), seat, back, *rails]


def sofa(stock: Stock, w: float, d: float, h: float, cloth: str = "cream", seats: int = 2) -> list[Part]:
    arm = 0.16 if seats > 1 else 0.13
    inner = w - 2 * arm
    parts = [
        stock.block(w * 0.98, d * 0.92, h * 0.24, cloth, 0.04).moved(0, 0, h * 0.18),
        stock.block(inner + 0.06, d * 0.26, h * 0.74, cloth, 0.07).moved(0, d * 0.37, h * 0.63),
    ]
    parts += [stock.block(arm, d * 0.95, h * 0.62, cloth, 0.06).moved(s * (w - arm) / 2, 0, h * 0.36) for s in (1, -1)]
    for k in range(seats):
        x = inner * ((k + 0.5) / seats - 0.5)
        parts.append(stock.block(inner / seats * 0.98, d * 0.66, h * 0.17, cloth, 0.06).moved(x, -d * 0.10, h * 0.38))
        parts.append(
            stock.block(inner / seats * 0.9, d * 0.16, h * 0.4, cloth, 0.06).turned(x=-10).moved(x, d * 0.2, h * 0.64)
        )
    pillow = stock.block(w * 0.2 if seats > 1 else w * 0.4, 0.12, h * 0.32, "coral", 0.055)
    parts.append(pillow.turned(x=-16, z=12).moved(inner * 0.28 if seats > 1 else 0, d * 0.06, h * 0.6))
    feet = [
        box(0.05, 0.05, h * 0.07, 0.004).moved(x * w * 0.44, y * d * 0.4, h * 0.035).painted(stock["walnut"])
        for x, y in product((1, -1), repeat=2)
    ]
    return [*parts, *(p.mapped(0.4) for p in feet)]


def bed(stock: Stock, w: float, d: float, h: float, wood: str = "birch", cloth: str = "sky") -> list[Part]:
    """Its head is at +Y."""
    parts = [
        stock.board(w, 0.035, h, wood).moved(0, d / 2 - 0.018, h / 2),
        stock.board(w, 0.035, h * 0.45, wood).moved(0, -d / 2 + 0.018, h * 0.225),
        stock.block(w * 0.94, d * 0.95, h * 0.22, "white", 0.05).moved(z=h * 0.42),
        stock.block(w * 0.98, d * 0.62, h * 0.2, cloth, 0.07).moved(0, -d * 0.16, h * 0.47),
        stock.block(w * 0.6, d * 0.17, h * 0.15, "white", 0.055).moved(0, d * 0.36, h * 0.58),
    ]
    return [
        *parts,
        *(stock.board(0.03, d - 0.06, h * 0.18, wood).moved(s * (w / 2 - 0.015), 0, h * 0.3) for s in (1, -1)),
    ]
