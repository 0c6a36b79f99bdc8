"""A closed warehouse of 40 x 20 m for mapping: racks with pallets, aisles, a packing area, docks and an office.

The origin is in the middle aisle. Walls, racks and pallets collide as boxes.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from common.catalogue import catalogue_stock
from common.colors import CREAM, SUN
from common.images import packed
from common.materials import material
from common.objects import exact, hidden_box, lamp, solid, twin, viewpoint
from common.racks import Goods, load, pallet, rack
from common.rooms import panes, trim, wall
from common.shapes import box, cylinder, rectangle
from common.sky import sky
from common.storage import shelf
from common.tables import rolling_chair, table
from common.textures import lines, speckle
from common.wood import planked

if TYPE_CHECKING:
    from common.parts import Part
    from common.stock import Stock

EAST, NORTH, HEIGHT, THICK = 20.0, 10.0, 6.0, 0.25
#: west end of the racks, bays in a rack, and the length of a bay
RACKS_FROM, BAYS, BAY = -17.5, 7, 2.8
#: centre of each rack and its open side, degrees about Z
ROWS = ((9.2, 0.0), (4.9, 180.0), (3.75, 0.0), (-3.75, 180.0), (-4.9, 0.0), (-9.2, 180.0))
#: the office in the north-east corner: its west and south wall, and their height
CORNER, LOW = (13.5, 4.5), 2.8
GATES = (-6.0, -1.5, 3.0)
STILL = {"physics_type": "STATIC"}
SHOWN = {"physics_type": "NO_COLLISION"}


def build() -> None:
    sky("#cfd8df")
    lamp("Sun", "SUN", 2.4, (0, -10, 20), (0.45, 0.25, 0.2), color="#fff4e2")
    for number, (x, y) in enumerate(((-12, 0), (-4, 6.9), (-4, -6.9), (5, 0), (12, -4), (16.5, 7)), start=1):
        lamp(f"Lamp{number}", "POINT", 260.0, (x, y, 5.2 if number < 6 else 2.5), color="#fff0d6", shadow=False)
    floor()
    hall()
    office()
    stock = catalogue_stock()
    goods = Goods.make()
    racks(goods)
    packing(stock, goods)
    viewpoint((-14.0, -27.0, 28.0), (-0.3, -1.2, 0.0), 25.0)


def floor() -> None:
    concrete = speckle(512, "#a3a6a6", "#b4b6b4", 91, coarse=5.0) * (1 - 0.10 * lines(512, 1, 0.006)[..., None])
    paint = material("Concrete", "#aaadac", 0.65, image=packed("concrete.jpg", concrete))
    asphalt = material("Asphalt", "#6d7073", 0.95, image=packed("asphalt.jpg", speckle(256, "#606366", "#74777a", 93)))
    exact(
        "Ground", [rectangle(180, 160).mapped(6.0).painted(asphalt)], (180, 160, 0), (0, 0, 0), (0, 0, -0.03), **STILL
    )
    parts = [rectangle(2 * EAST, 2 * NORTH).mapped(5.0).painted(paint), *marks()]
    solid("Floor", parts, **SHOWN)
    hidden_box("Floor_bb", (2 * EAST + THICK, 2 * NORTH + THICK, 0.2), (0, 0, -0.1), **STILL)


def marks() -> list[Part]:
    """Yellow lines along the aisles, a crossing, and marked areas in front of the gates."""
    yellow, white = material("Line", SUN, 0.7), material("Place", CREAM, 0.7)
    end = RACKS_FROM + BAYS * BAY
    strips = [(RACKS_FROM - 1.2, end + 1.2, y) for y in (8.45, 5.65, 2.95, -2.95, -5.65, -8.45)]
    parts = [rectangle(x1 - x0, 0.1).moved((x0 + x1) / 2, y, 0.004).painted(yellow) for x0, x1, y in strips]
    parts += [rectangle(0.45, 2.4).moved(end + 2.0 + 0.9 * k, 0.0, 0.004).painted(white) for k in range(4)]
    for y in GATES:
        for x0, x1, y0, y1 in ((15.2, 19.0, -1.3, -1.2), (15.2, 19.0, 1.2, 1.3), (15.2, 15.3, -1.3, 1.3)):
            parts.append(rectangle(x1 - x0, y1 - y0).moved((x0 + x1) / 2, y + (y0 + y1) / 2, 0.004).painted(yellow))
    return parts


def hall() -> None:
    """Walls, closed gates in the east wall, columns, and a roof that is visible only from inside."""
    panel = speckle(256, "#dfe3e4", "#e9ecec", 95) * (1 - 0.12 * lines(256, 4, 0.03)[..., None])
    paint = material("Wall", "#e4e8e9", 0.8, image=packed("panel.jpg", panel))
    lines_ = (
        ((-EAST, -NORTH), (EAST, -NORTH), tuple((x, x + 3.0, 3.6, 4.8) for x in (4.0, 12.0, 20.0, 28.0, 34.0))),
        ((-EAST, NORTH), (EAST, NORTH), ()),
        ((-EAST, THICK - NORTH), (-EAST, NORTH - THICK), ((8.7, 10.8, 3.6, 4.8),)),
        ((EAST, THICK - NORTH), (EAST, NORTH - THICK), ()),
    )
    pieces = [part for line in lines_ for part in wall(*line, THICK, HEIGHT)]
    solid("Walls", [part.mapped(4.0).painted(paint) for part in pieces], **STILL)
    glass = material("Glass", "#a9ccd9", 0.1)
    solid("Panes", [part.painted(glass) for line in lines_ for part in panes(*line, 0.05)], **STILL)
    base = material("Base", "#37607a", 0.8)
    parts = [part.painted(base) for start, end, _ in lines_ for part in trim(start, end, (), THICK)[0]]
    shutter, frame = material("Shutter", "#c9cfd2", 0.5, 0.2), material("Gate", "#e0a92e", 0.6)
    x = EAST - THICK / 2 - 0.04
    for y in GATES:
        parts += [box(0.05, 2.9, 0.27).moved(x + 0.01, y, 0.15 + 0.285 * k).painted(shutter) for k in range(12)]
        parts += [box(0.08, 0.2, 3.6).moved(x, y + side, 1.8).painted(frame) for side in (-1.55, 1.55)]
        parts.append(box(0.08, 3.3, 0.2).moved(x, y, 3.6).painted(frame))
    solid("Gates", parts, **SHOWN)
    steel = material("Column", "#4a7f9c", 0.6)
    first = None
    for number, (x, y) in enumerate((x, y) for x in (4.6, 12.6) for y in (-NORTH + 0.35, NORTH - 0.35)):
        column = [box(0.3, 0.3, HEIGHT).moved(z=HEIGHT / 2).painted(steel)]
        name = f"Column.{number:03}" if number else "Column"
        first = twin(first, name, (x, y, 0), **STILL) if first else solid(name, column, (x, y, 0), **STILL)
    roof = material("Roof", "#dfe3e6", 0.9, glow=0.25, one_sided=True)
    glow = material("Tube", "#fff6e0", 0.5, glow=1.2, one_sided=True)
    solid("Ceiling", [rectangle(2 * EAST, 2 * NORTH).turned(x=180).painted(roof)], (0, 0, HEIGHT), **STILL)
    tubes = [
        rectangle(2.4, 0.25).turned(x=180).moved(x, y).painted(glow)
        for x in np.linspace(-16, 16, 9)
        for y in (-7, 0, 7)
    ]
    solid("CeilingLamps", tubes, (0, 0, HEIGHT - 0.02), **SHOWN)


def office() -> None:
    """Two walls with a door, a window and their own roof."""
    (x, y), white = CORNER, material("Partition", "#f1eee6", 0.85)
    lines_ = (
        ((x, y), (EAST - THICK, y), ((0.7, 2.1, 0.0, 2.1), (2.9, 5.3, 0.9, 2.1))),
        ((x, y + 0.12), (x, NORTH - THICK), ((1.4, 3.9, 0.9, 2.1),)),
    )
    solid("OfficeWalls", [p.mapped(2.0).painted(white) for line in lines_ for p in wall(*line, 0.12, LOW)], **STILL)
    glass, oak = material("Window", "#b6d4de", 0.1), material("Frame", "#9c7146", 0.6)
    solid("OfficePanes", [p.painted(glass) for line in lines_ for p in panes(*line, 0.03)], **STILL)
    boards, frames = zip(*(trim(*line, 0.12) for line in lines_), strict=True)
    solid("OfficeTrim", [p.painted(oak) for parts in (*boards, *frames) for p in parts], **SHOWN)
    moss = material("Moss Carpet", "#7b8b70", 0.95, image=packed("moss.jpg", speckle(256, "#6f7f66", "#87977a", 78)))
    size = (EAST - x, NORTH - y)
    solid(
        "OfficeFloor", [rectangle(*size).mapped(2.0).painted(moss)], (x + size[0] / 2, y + size[1] / 2, 0.005), **SHOWN
    )


def racks(goods: Goods) -> None:
    variants: dict[bool, object] = {}
    middle = RACKS_FROM + BAYS * BAY / 2
    for number, (y, turn) in enumerate(ROWS):
        name, odd = (f"Rack.{number:03}" if number else "Rack"), bool(number % 2)
        pose = ((middle, y, 0.0), (0.0, 0.0, math.radians(turn)))
        if odd in variants:
            twin(variants[odd], name, *pose, **STILL)
        else:
            variants[odd] = solid(name, rack(goods, BAYS, BAY, seed=5 + odd), *pose, **STILL)


def packing(stock: Stock, goods: Goods) -> None:
    """Objects between the racks and the gates."""
    loads = [
        (16.2, -6.4, 3.0),
        (17.6, -5.6, -4.0),
        (16.4, -1.2, 0.0),
        (17.7, -1.9, 88.0),
        (17.0, 2.9, 5.0),
        (9.2, 8.8, 0.0),
    ]
    for number, (x, y, turn) in enumerate(loads):
        name = f"Pallet.{number:03}" if number else "Pallet"
        parts = [*pallet(goods), *(p.moved(z=0.144) for p in load(goods, np.random.default_rng(60 + number), 1.3))]
        solid(name, parts, (x, y, 0), (0, 0, math.radians(turn)), **STILL)
    empties = [part.moved(z=0.144 * k) for k in range(6) for part in pallet(goods)]
    solid("PalletStack", empties, (8.0, -9.0, 0), (0, 0, 0.06), **STILL)
    benches = (((7.2, 7.4), 0.0), ((10.4, 7.4), 0.0), ((10.8, -8.9), 180.0), ((16.4, 8.9), 0.0))
    for number, ((x, y), turn) in enumerate(benches):
        name = f"Bench.{number:03}" if number else "Bench"
        solid(
            name,
            table(stock, 2.2, 0.8, 0.85, "birch", "birch", shelf=True),
            (x, y, 0),
            (0, 0, math.radians(turn)),
            **STILL,
        )
    for number, (x, y, turn) in enumerate(((19.55, 6.2, -90), (14.0, 9.5, 0), (13.6, -9.6, 180), (15.2, -9.6, 180))):
        name = f"Shelf.{number:03}" if number else "Shelf"
        parts = shelf(stock, 1.4, 0.45, 2.0, 4, 2, "oak", 31 + number)
        solid(name, parts, (x, y, 0), (0, 0, math.radians(turn)), collision="box", **STILL)
    solid(
        "OfficeChair", rolling_chair(stock, 0.6, 0.63, 0.93), (16.2, 8.1, 0), (0, 0, 2.9), collision="convex", **STILL
    )
    crate = planked("Crate Wood", "#9a6a3a", "#d8a868", 5, boards=5)
    boxes = [box(1.0, 1.0, 1.0).mapped(1.0, offset=(0.5, 0.5)).moved(0, 0, 0.5).painted(crate)]
    for number, (x, y, turn) in enumerate(((12.4, -8.6, 0.3), (13.0, 1.4, 0.1), (6.6, -6.2, -0.2))):
        name = f"Crate.{number:03}" if number else "Crate"
        solid(name, boxes, (x, y, 0), (0, 0, turn), collision="box", **STILL)
    posts = [(x, y) for x in (RACKS_FROM - 0.45, RACKS_FROM + BAYS * BAY + 0.45) for y in (2.9, 5.75, -2.9, -5.75)]
    guard = [cylinder(0.09, 1.0, 0.01, 16).moved(z=0.5).painted(material("Guard", SUN, 0.5))]
    guard.append(cylinder(0.092, 0.14, 0.0, 16).moved(z=0.75).painted(stock["black"]))
    first = None
    for number, (x, y) in enumerate(posts):
        name = f"Post.{number:03}" if number else "Post"
        options = {"collision": "cylinder", **STILL}
        first = twin(first, name, (x, y, 0), **options) if first else solid(name, guard, (x, y, 0), **options)
