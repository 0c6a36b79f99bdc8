"""Shelves, cupboards and bins in any size.

Width along X, depth along Y with the front towards -Y; they stand on z=0, their middle over the origin.
"""

from __future__ import annotations

from itertools import product
from typing import TYPE_CHECKING

import numpy as np

from common.parts import Part
from common.shapes import box, cylinder, lathe, tube

if TYPE_CHECKING:
    from common.stock import Stock


def shelf(
    stock: Stock,
    w: float,
    d: float,
    h: float,
    rows: int = 4,
    columns: int = 1,
    wood: str = "birch",
    books: int | None = 1,
) -> list[Part]:
    """Open boxes with books; ``books`` is the seed, None leaves it empty."""
    t = 0.022 * max(w, h) ** 0.3
    parts = [stock.board(t, d, h, wood).moved(x, 0, h / 2) for x in np.linspace(-(w - t) / 2, (w - t) / 2, columns + 1)]
    bay, pitch = (w - t * (columns + 1)) / columns, (h - t) / rows
    floor = stock.board(w - 2 * t, d * 0.98, t, wood)
    parts += [floor.moved(z=t / 2 + k * pitch) for k in range(rows + 1)]
    parts.append(stock.board(w - 2 * t, 0.008, h - 2 * t, wood, 0.001).moved(0, d / 2 - 0.008, h / 2))
    if books is not None:
        random = np.random.default_rng(books)
        for row, column in product(range(rows), range(columns)):
            left = -w / 2 + t + column * (bay + t)
            parts += row_of_books(stock, random, left + 0.01, left + bay, t * 1.5 + row * pitch, pitch - t, d)
    return parts


def row_of_books(
    stock: Stock, random: np.random.Generator, start: float, end: float, z: float, room: float, d: float
) -> list[Part]:
    paints = ("coral", "teal", "navy", "sun", "plum", "cream", "berry", "sky")
    parts, x = [], start
    stop = start + (end - start) * random.uniform(0.45, 0.95)
    while True:
        thick, high, deep = (
            room * random.uniform(0.08, 0.18),
            room * random.uniform(0.62, 0.9),
            d * random.uniform(0.6, 0.75),
        )
        if x + thick > stop:
            return parts
        book = box(thick * 0.94, deep, high, 0.003).painted(stock[paints[int(random.integers(len(paints)))]])
        parts.append(book.moved(x + thick / 2, d * 0.42 - deep / 2, z + high / 2))
        x += thick


def cupboard(
    stock: Stock, w: float, d: float, h: float, doors: int = 2, wood: str = "birch", front: str = "white"
) -> list[Part]:
    parts = [
        stock.board(w, d * 0.94, h - 0.06, wood).moved(0, d * 0.03, (h + 0.06) / 2),
        box(w * 0.96, d * 0.85, 0.06).painted(stock["black"]).moved(0, d * 0.03, 0.03),
    ]
    width = w / doors
    for k in range(doors):
        x = width * (k + 0.5) - w / 2
        parts.append(
            stock.block(width * 0.97, 0.025, (h - 0.06) * 0.97, front, 0.006).moved(x, -d / 2 + 0.0125, (h + 0.06) / 2)
        )
        side = 1 if k % 2 == 0 and doors > 1 else -1
        parts.append(
            tube([(x + side * width * 0.4, -d / 2 - 0.012, h * 0.5 + z) for z in (-0.06, 0.06)], 0.007, 8).painted(
                stock["steel"]
            )
        )
    return parts


def chest(stock: Stock, w: float, d: float, h: float, rows: int = 3, wood: str = "walnut") -> list[Part]:
    """A chest of drawers on short legs."""
    base = h * 0.1
    parts = [
        stock.board(w, d, 0.03, wood).moved(z=h - 0.015),
        stock.board(w * 0.96, d * 0.92, h - base - 0.03, wood).moved(0, d * 0.02, (h + base - 0.03) / 2),
    ]
    pitch = (h - base - 0.03) / rows
    for k in range(rows):
        z = base + pitch * (k + 0.5)
        parts.append(stock.board(w * 0.92, 0.02, pitch * 0.9, wood).moved(0, -d * 0.45, z))
        parts += [
            cylinder(0.016, 0.03, 0.006, 14).turned(x=90).moved(x, -d * 0.47, z).painted(stock["steel"])
            for x in (-w * 0.28, w * 0.28)
        ]
    parts += [
        stock.board(0.05, 0.05, base, wood).moved(x * w * 0.44, y * d * 0.4, base / 2)
        for x, y in product((1, -1), repeat=2)
    ]
    return parts


def drawer_block(stock: Stock, w: float, d: float, h: float, rows: int = 3) -> list[Part]:
    parts = [stock.block(w, d * 0.96, h - 0.05, "white", 0.01).moved(0, d * 0.02, (h + 0.05) / 2)]
    pitch = (h - 0.07) / rows
    for k in range(rows):
        z = 0.06 + pitch * (k + 0.5)
        parts.append(
            stock.block(w * 0.95, 0.02, pitch * 0.92, "sky" if k == rows - 1 else "white", 0.006).moved(
                0, -d / 2 + 0.01, z
            )
        )
        parts.append(
            box(w * 0.3, 0.012, 0.012, 0.003).moved(0, -d / 2 - 0.004, z + pitch * 0.25).painted(stock["steel"])
        )
    return [
        *parts,
        *(
            cylinder(0.022, 0.04, 0.004, 12).moved(x * w * 0.4, y * d * 0.4, 0.022).painted(stock["black"])
            for x, y in product((1, -1), repeat=2)
        ),
    ]


def bin_of_pieces(stock: Stock, radius: float, height: float, paint: str, segments: int = 12) -> list[Part]:
    """An open bin with a white rim; each piece of its wall is convex, so that objects can fall in."""
    floor = [(0, 0), (radius * 0.82, 0.0), (radius * 0.83, 0.012), (0, 0.012)]
    parts = [lathe(floor, segments * 2).painted(stock[paint])]
    for low, high, color in ((0.0, 0.9, paint), (0.9, 1.0, "white")):
        piece = wall_piece(radius, height, low, high, np.pi / segments).painted(stock[color])
        parts += [piece.turned(z=360 * k / segments) for k in range(segments)]
    return parts


def wall_piece(radius: float, height: float, low: float, high: float, half_angle: float) -> Part:
    """A sector of the wall of a bin that widens upwards, between two shares of its height."""
    corners = []
    for share in (low, high):
        outer = (0.82 + 0.18 * share) * radius
        for r in (outer, outer - 0.06 * radius):
            corners += [(r * np.cos(a), r * np.sin(a), share * height) for a in (-half_angle, half_angle)]
    faces = [(0, 1, 5, 4), (3, 2, 6, 7), (4, 5, 7, 6), (1, 0, 2, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    return Part(np.array(corners), faces, smooth=False)
