"""The furniture of the office: name, position in the building and heading in degrees."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from common import household, storage, tables
from common.catalogue import catalogue_stock, print_board
from common.colors import CORAL, SKY, TEAL
from common.images import packed
from common.materials import material
from common.objects import solid, twin
from common.posters import alphabet, hello
from common.shapes import box, cylinder, ellipsoid, lathe, rectangle, rounded_box

if TYPE_CHECKING:
    from collections.abc import Callable

    from common.objects import Triple
    from common.parts import Part
    from common.stock import Stock

#: pieces whose collision shape is not that of their boards
SHAPES = {
    "Shelf": "box", "Cupboard": "box", "Printer": "box", "Radiator": "box", "Counter": "box", "Fridge": "box",
    "Sofa": "convex", "OfficeChair": "convex", "Plant": "cylinder", "Server": "box",
}  # fmt: skip
#: pieces by room; a heading of 0 faces -Y
PLACES: dict[str, tuple[tuple[float, float, float], ...]] = {
    "Desk": (
        *((x, -8.35, 180) for x in (-6.4, -3.6, -0.8, 2.0)), (-3.6, -5.9, 0), (-0.8, -5.9, 0),
        (-12.4, 7.0, 90), (-3.1, 6.9, -90), (2.1, 6.9, -90),
        *((x, y, turn) for x in (5.0, 8.2, 11.4) for y, turn in ((8.4, 0), (6.3, 180))),
        (12.4, -6.4, -90), (6.4, -8.4, 180),
    ),
    "OfficeChair": (
        *((x, -7.65, 10) for x in (-6.5, -3.5, -0.9, 2.1)), (-3.7, -6.6, 170), (-0.7, -6.6, 190),
        (-11.7, 7.1, -80), (-3.8, 6.8, 100), (1.4, 7.0, 80),
        *((x, y, turn) for x in (5.1, 8.1, 11.5) for y, turn in ((7.7, 190), (7.0, 5))),
        (11.7, -6.5, 95), (6.3, -7.7, -10),
    ),
    "Shelf": ((-8.3, 6.3, -90), (-6.6, 8.7, 0), (-1.2, 8.7, 0), (3.6, -6.6, -90), (4.4, -5.6, 90), (2.3, 1.9, 0),
        (3.5, 1.9, 0), (4.7, 1.9, 0)),
    "Cupboard": ((-7.65, 6.6, 90), (2.25, 5.4, -90), (-7.6, -7.2, 90), (12.6, 5.1, -90), (9.2, -8.6, 180)),
    "Printer": ((1.0, -1.7, 180),),
    "Server": ((5.55, -1.2, -90), (5.55, -0.2, -90)),
    "Radiator": ((-10.5, 8.82, 0), (0.0, 8.82, 0), (12.82, 1.6, -90), (12.82, -1.6, -90), (-12.82, 2.7, 90)),
    "Plant": ((-12.4, -3.7, 0), (-12.4, 3.7, 40), (7.55, 3.75, 80), (-7.5, -3.7, 10), (12.3, 3.6, 60),
        (-5.5, -1.75, 20), (3.2, 4.75, 10), (12.4, -8.4, 0)),
    "Sofa": ((-10.4, 3.65, 0), (-12.45, 1.2, 90)),
    "LowTable": ((-10.6, 2.2, 0),),
    "Reception": ((-9.6, -2.6, -90),),
    "BigTable": ((10.6, 0.0, 90),),
    "MeetingTable": ((-3.2, 0.0, 0),),
    "Chair": (
        *((x, y, turn) for y in (-1.3, -0.45, 0.45, 1.3) for x, turn in ((9.55, 90), (11.65, -90))),
        *((x, y, turn) for x in (-4.1, -3.2, -2.3) for y, turn in ((0.85, 0), (-0.85, 180))),
        (-11.3, -6.9, 90), (-9.7, -6.9, -90), (-10.5, -6.1, 0), (-10.5, -7.7, 180),
    ),
    "RoundTable": ((-10.5, -6.9, 0),),
    "Counter": ((-12.62, -6.4, 90), (-12.62, -8.2, 90)),
    "Fridge": ((-8.45, -8.55, -90),),
    "Whiteboard": ((-5.55, 0.2, 90), (8.6, -3.4, 150), (3.1, 7.6, 90)),
}  # fmt: skip
#: image, position on a wall, heading, width and height
POSTERS = (
    ("Hello", (-12.915, 0.0, 1.6), 90.0, 1.2, 1.5),
    ("Alphabet", (-6.085, 0.9, 1.5), -90.0, 0.9, 1.2),
    ("Hello", (6.085, 0.0, 1.5), 90.0, 0.9, 1.2),
    ("Alphabet", (8.09, 2.4, 1.5), 90.0, 0.9, 1.2),
)
RUGS = ((-10.7, 2.1, 3.0, 2.0, TEAL), (-5.2, 6.6, 2.4, 1.8, CORAL), (7.2, -6.4, 2.6, 1.9, SKY))


def furnish(at: Triple) -> None:
    """Place everything in the building with its centre at ``at``."""
    stock = catalogue_stock()
    for name, places in PLACES.items():
        make = PIECES[name]
        options = {"physics_type": "STATIC", **({"collision": SHAPES[name]} if name in SHAPES else {})}
        first = None
        for number, (x, y, heading) in enumerate(places):
            title = f"{name}.{number:03}" if number else name
            place, turned = (x + at[0], y + at[1], at[2]), (0.0, 0.0, math.radians(heading))
            if first is None:
                first = solid(title, make(stock), place, turned, **options)
            else:
                twin(first, title, place, turned, **options)
    decorate(stock, at)


def decorate(stock: Stock, at: Triple) -> None:
    """Rugs, pictures, and objects on the desks, without collision."""
    parts = []
    for number, (x, y, w, d, color) in enumerate(RUGS):
        paint = material(f"Rug {number + 1}", color, 0.95)
        parts.append(rectangle(w, d).moved(x, y, 0.006).painted(paint))
        parts.append(rectangle(w - 0.3, d - 0.3).moved(x, y, 0.008).painted(stock["cream"]))
        parts.append(rectangle(w - 0.4, d - 0.4).moved(x, y, 0.010).painted(paint))
    pictures = {
        "Hello": material("Poster Hello", "#ffffff", 0.7, image=packed("office_hello.png", hello())),
        "Alphabet": material("Poster Alphabet", "#ffffff", 0.7, image=packed("office_alphabet.png", alphabet())),
    }
    for name, (x, y, z), heading, w, h in POSTERS:
        edge = box(w + 0.06, 0.02, h + 0.06, 0.004).painted(stock["walnut"])
        sheet = rectangle(w, h).stretched_over((0, 1)).turned(x=90).moved(y=-0.012).painted(pictures[name])
        parts += [part.turned(z=heading).moved(x, y, z) for part in (edge, sheet)]
    for number, (x, y, heading) in enumerate(PLACES["Desk"]):
        parts += [part.turned(z=heading).moved(x, y, 0.73) for part in workplace(stock, number)]
    solid("Decoration", parts, at, physics_type="NO_COLLISION")


def workplace(stock: Stock, number: int) -> list[Part]:
    """A screen, a keyboard, and a mug or some paper, on z=0."""
    screen = [
        rounded_box(0.58, 0.03, 0.34, 0.012, 1).moved(0, 0.2, 0.32).painted(stock["black"]),
        box(0.54, 0.004, 0.30).moved(0, 0.183, 0.32).painted(stock["sky" if number % 2 else "teal"]),
        box(0.05, 0.04, 0.16).moved(0, 0.215, 0.09).painted(stock["steel"]),
        box(0.22, 0.16, 0.012, 0.003).moved(0, 0.2, 0.006).painted(stock["steel"]),
    ]
    keys = box(0.42, 0.14, 0.018, 0.004).moved(0, -0.12, 0.009).painted(stock["navy"])
    if number % 3:
        return [*screen, keys, box(0.21, 0.3, 0.006).turned(z=12).moved(-0.45, -0.05, 0.003).painted(stock["paper"])]
    mug = lathe([(0, 0), (0.04, 0), (0.042, 0.09), (0.034, 0.09), (0.03, 0.01), (0, 0.01)], 14)
    return [*screen, keys, mug.moved(0.42, -0.02).painted(stock["coral"])]


def counter(stock: Stock) -> list[Part]:
    """A kitchen counter of 1.8 m."""
    parts = storage.cupboard(stock, 1.8, 0.6, 0.86, 3, "birch", "teal")
    return [*parts, box(1.84, 0.63, 0.04, 0.006).moved(z=0.88).painted(stock["stone"])]


def fridge(stock: Stock) -> list[Part]:
    parts = [
        rounded_box(0.6, 0.62, z, 0.025, 2).moved(z=at).painted(stock["white"]) for z, at in ((0.6, 0.3), (1.2, 1.22))
    ]
    return [*parts, *(box(0.02, 0.03, 0.3).moved(-0.24, -0.325, z).painted(stock["steel"]) for z in (0.42, 0.85))]


def reception(stock: Stock) -> list[Part]:
    """A desk with a high front."""
    parts = tables.desk(stock, 2.2, 0.75, 0.74, "oak", 3)
    return [
        *parts,
        stock.board(2.3, 0.05, 1.1, "walnut").moved(0, 0.42, 0.55),
        stock.board(2.3, 0.3, 0.04, "oak").moved(0, 0.36, 1.12),
    ]


def round_table(stock: Stock) -> list[Part]:
    """Each piece is convex."""
    foot, post = (cylinder(r, h, 0.004, 28).painted(stock["steel"]) for r, h in ((0.3, 0.03), (0.045, 0.67)))
    top = cylinder(0.5, 0.04, 0.006, 40).moved(z=0.72).painted(stock["birch"])
    return [foot.moved(z=0.015), post.moved(z=0.365), top]


def server(stock: Stock) -> list[Part]:
    """A cabinet of computers with lamps."""
    parts = [rounded_box(0.6, 0.8, 1.9, 0.015, 1).moved(z=0.95).painted(stock["black"])]
    for k in range(9):
        z = 0.25 + 0.18 * k
        parts.append(box(0.52, 0.012, 0.12).moved(0, -0.403, z).painted(stock["steel"]))
        dots = ellipsoid(0.008, 0.006, 0.008, columns=6, rows=4)
        parts.append(dots.moved(0.2, -0.412, z).painted(stock["leaf" if k % 4 else "red"]))
    return parts


PIECES: dict[str, Callable[[Stock], list[Part]]] = {
    "Desk": lambda s: tables.desk(s, 1.6, 0.8, 0.73, "birch", 3),
    "OfficeChair": lambda s: tables.rolling_chair(s, 0.6, 0.63, 0.93),
    "Shelf": lambda s: storage.shelf(s, 1.1, 0.34, 1.9, 5, 2, "birch", 21),
    "Cupboard": lambda s: storage.cupboard(s, 1.0, 0.45, 1.9, 2, "birch", "white"),
    "Printer": lambda s: print_board(s, 0.9, 0.6, 1.1),
    "Server": server,
    "Radiator": lambda s: household.radiator(s, 1.2, 0.1, 0.55),
    "Plant": lambda s: household.plant(s, 0.62, 1.35, 24, 3),
    "Sofa": lambda s: tables.sofa(s, 1.9, 0.85, 0.8, "coral", 2),
    "LowTable": lambda s: tables.table(s, 1.1, 0.6, 0.42, "walnut", "walnut"),
    "Reception": reception,
    "BigTable": lambda s: tables.table(s, 3.6, 1.4, 0.75, "walnut", "walnut"),
    "MeetingTable": lambda s: tables.table(s, 2.8, 1.1, 0.75, "oak", "oak"),
    "Chair": lambda s: tables.chair(s, 0.44, 0.48, 0.9, "walnut"),
    "RoundTable": round_table,
    "Counter": counter,
    "Fridge": fridge,
    "Whiteboard": lambda s: household.whiteboard(s, 1.6, 0.6, 1.9, s["sketch"]),
}
