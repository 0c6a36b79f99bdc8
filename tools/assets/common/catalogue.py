"""Pieces of furniture by their names in model files, in any size."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from common import household, storage, tables
from common.colors import SUN
from common.images import packed
from common.materials import material
from common.objects import exact
from common.parts import Part, bounds, in_frame_of, rotation
from common.posters import sketch
from common.shapes import box, cylinder, rounded_box, tube
from common.stock import Stock
from common.toys import stool

if TYPE_CHECKING:
    from common.objects import Triple


def carpet(stock: Stock, w: float, d: float, h: float) -> list[Part]:
    parts = [box(w, d, h * 0.8).moved(z=h * 0.4).painted(stock["berry"])]
    for k, paint in enumerate(("cream", "coral", "cream")):
        parts.append(
            box(w * (0.88 - 0.12 * k), d * (0.92 - 0.08 * k), h * 0.05)
            .moved(z=h * (0.82 + 0.06 * k))
            .painted(stock[paint])
        )
    return parts


def pillow(stock: Stock, w: float, d: float, h: float) -> list[Part]:
    return [rounded_box(w, d, h, h * 0.49, 3).painted(stock["coral"])]


def hanger(stock: Stock, w: float, d: float, h: float) -> list[Part]:
    """A coat rack on the wall, with a coat."""
    parts = [
        stock.board(w, 0.03, 0.14, "oak").moved(0, d * 0.45, h * 0.9),
        stock.board(w, d * 0.6, 0.03, "oak").moved(0, d * 0.15, h * 0.99),
    ]
    hook = tube([(0, d * 0.42, h * 0.88), (0, d * 0.25, h * 0.85), (0, d * 0.22, h * 0.9)], 0.012, 8)
    parts += [hook.moved(x=x).painted(stock["steel"]) for x in np.linspace(-w * 0.42, w * 0.42, 6)]
    parts.append(rounded_box(w * 0.36, d * 0.4, h * 0.7, 0.08, 2).moved(-w * 0.2, 0, h * 0.4).painted(stock["navy"]))
    parts.append(rounded_box(w * 0.22, d * 0.3, h * 0.5, 0.06, 2).moved(w * 0.22, 0, h * 0.5).painted(stock["coral"]))
    return parts


def coffee_table(stock: Stock, w: float, d: float, h: float) -> list[Part]:
    return tables.table(stock, w, d, h, "walnut", "walnut")


def side_lamp(stock: Stock, w: float, d: float, h: float) -> list[Part]:
    return household.floor_lamp(stock, w, h, stock["shade"])


def overhead_lamp(stock: Stock, w: float, d: float, h: float) -> list[Part]:
    parts = [
        tube([(0, 0, h * 0.12), (0, 0, h)], 0.012, 8).painted(stock["steel"]),
        box(w, d, h * 0.05, 0.01).moved(z=h * 0.09).painted(stock["white"]),
    ]
    return [
        *parts,
        *(
            cylinder(0.03, d * 0.94, 0.005, 14).turned(x=90).moved(x, 0, h * 0.045).painted(stock["shade"])
            for x in (-w * 0.25, w * 0.25)
        ),
    ]


def print_board(stock: Stock, w: float, d: float, h: float) -> list[Part]:
    """A printer on a low table."""
    parts = tables.table(stock, w, d, h * 0.5, "birch", "birch")
    parts.append(rounded_box(w * 0.8, d * 0.75, h * 0.42, 0.03, 2).moved(z=h * 0.73).painted(stock["white"]))
    parts.append(box(w * 0.6, 0.06, 0.012, 0.002).moved(0, -d * 0.38, h * 0.62).painted(stock["paper"]))
    return [
        *parts,
        box(w * 0.62, d * 0.5, 0.02, 0.004).turned(x=30).moved(0, d * 0.25, h * 0.98).painted(stock["black"]),
    ]


def rolled_staff(stock: Stock, w: float, d: float, h: float) -> list[Part]:
    """Rolls of paper in a bin."""
    parts = storage.bin_of_pieces(stock, w * 0.45, h * 0.5, "stone")
    for k, (x, y) in enumerate(((0.05, 0.04), (-0.06, 0.02), (0.0, -0.07), (0.07, -0.05))):
        roll = tube([(x, y, 0.02), (x * 1.4, y * 1.4 + 0.02, h * (1.0 - 0.1 * k))], 0.03, 10).painted(
            stock["paper" if k % 2 else "cream"]
        )
        parts.append(roll)
    return parts


def skylight(stock: Stock, w: float, d: float, h: float) -> list[Part]:
    """A slanted window in its frame."""
    frame = [stock.board(w, 0.09, 0.1, "birch").moved(z=s * (h / 2 - 0.05) + h / 2) for s in (1, -1)]
    frame += [stock.board(0.1, 0.09, h, "birch").moved(s * (w / 2 - 0.05), 0, h / 2) for s in (1, -1)]
    frame += [
        box(w - 0.2, 0.02, h - 0.2).moved(z=h / 2).painted(stock["glass"]),
        stock.board(w, 0.05, 0.06, "birch").moved(z=h / 2),
    ]
    angle = np.degrees(np.arctan2(d, h)) * 0.8
    return [p.turned(x=angle) for p in frame]


def red_chair(stock: Stock, w: float, d: float, h: float) -> list[Part]:
    seat = rounded_box(w * 0.9, d * 0.8, h * 0.09, h * 0.04, 2).moved(z=h * 0.48).painted(stock["red"])
    back = (
        rounded_box(w * 0.9, h * 0.07, h * 0.5, h * 0.03, 2)
        .turned(x=-8)
        .moved(0, d * 0.4, h * 0.75)
        .painted(stock["red"])
    )
    legs = [
        tube([(x * w * 0.38, y * d * 0.34, h * 0.46), (x * w * 0.46, y * d * 0.44, 0.0)], h * 0.02, 8, round_ends=False)
        for x in (1, -1)
        for y in (1, -1)
    ]
    return [seat, back, *(leg.painted(stock["steel"]) for leg in legs)]


def office_shelf(rows: int, columns: int, wood: str, seed: int):
    def build(stock: Stock, w: float, d: float, h: float) -> list[Part]:
        return storage.shelf(stock, w, d, h, rows, columns, wood, seed)

    return build


def board_with_sketch(stock: Stock, w: float, d: float, h: float) -> list[Part]:
    return household.whiteboard(stock, w, d, h, stock["sketch"])


def glass_cupboard(stock: Stock, w: float, d: float, h: float) -> list[Part]:
    parts = storage.shelf(stock, w, d * 0.95, h, 5, 2, "birch", 9)
    return [p.moved(y=d * 0.025) for p in parts] + [
        box(w * 0.47, 0.012, h * 0.94, 0.002).moved(s * w * 0.245, -d / 2 + 0.006, h / 2).painted(stock["glass"])
        for s in (1, -1)
    ]


def console(stock: Stock, w: float, d: float, h: float) -> list[Part]:
    parts = tables.table(stock, w, d, h, "walnut", "walnut", shelf=True)
    parts += [
        stock.board(w * 0.3, 0.02, h * 0.16, "walnut").moved(x, -d / 2 + 0.02, h * 0.86)
        for x in (-w * 0.31, 0, w * 0.31)
    ]
    return [
        *parts,
        *(
            cylinder(0.014, 0.02, 0.004, 12).turned(x=90).moved(x, -d / 2, h * 0.86).painted(stock["steel"])
            for x in (-w * 0.31, 0, w * 0.31)
        ),
    ]


#: the longest matching prefix of the name of an object is used
PIECES: dict[str, Any] = {
    "basic_desk": lambda s, w, d, h: tables.table(s, w, d, h, "birch", "birch"),
    "basic_pillow": pillow,
    "cupboard_large": storage.cupboard,
    "cupboard_large_open": glass_cupboard,
    "cupboard_small": lambda s, w, d, h: storage.cupboard(s, w, d, h, 2, "birch", "teal"),
    "Desk_1": lambda s, w, d, h: tables.desk(s, w, d, h, "oak", 3),
    "Desk_2": lambda s, w, d, h: tables.table(s, w, d, h, "walnut", "walnut", shelf=True),
    "Desk_3": lambda s, w, d, h: tables.table(s, w, d, h, "oak", "oak"),
    "hanger": hanger,
    "Heater": household.radiator,
    "IKEA_armchair": lambda s, w, d, h: tables.sofa(s, w, d, h, "sun", 1),
    "IKEA_bed": tables.bed,
    "IKEA_carpet": carpet,
    "IKEA_chair_PELLO": tables.easy_chair,
    "IKEA_chair_STEFAN": lambda s, w, d, h: tables.chair(s, w, d, h, "walnut"),
    "IKEA_chest": storage.chest,
    "IKEA_console": console,
    "IKEA_cupboard_BILLY_1": lambda s, w, d, h: storage.shelf(s, w, d, h, 5, 1, "birch", 3),
    "IKEA_cupboard_BILLY_2": lambda s, w, d, h: storage.shelf(s, w, d, h, 3, 1, "birch", 4),
    "IKEA_cupboard_BILLY": lambda s, w, d, h: storage.shelf(s, w, d, h, 3, 1, "birch", 5),
    "IKEA_lamp": side_lamp,
    "IKEA_low_table": coffee_table,
    "IKEA_Plant_1": lambda s, w, d, h: household.plant(s, w, h, 22, 3),
    "IKEA_Plant_2": lambda s, w, d, h: household.plant(s, w, h, 30, 5),
    "IKEA_RUTBO": side_lamp,
    "IKEA_sofa": lambda s, w, d, h: tables.sofa(s, w, d, h, "teal", 2),
    "IKEA_table": lambda s, w, d, h: tables.table(s, w, d, h, "birch", "birch"),
    "office_desk": lambda s, w, d, h: tables.desk(s, w, d, h, "birch", 0),
    "office_drawer_block": lambda s, w, d, h: storage.drawer_block(s, w, d, h),
    "Overhead_Lamp": overhead_lamp,
    "Print_board": print_board,
    "Red_Chair": red_chair,
    "red_heat": red_chair,
    "rolled_staff": rolled_staff,
    "Rolling_Chair": tables.rolling_chair,
    "Stool": lambda s, w, d, h: stool(s.saw, s["oak"], s["steel"]),
    "Shelf_1": office_shelf(4, 1, "oak", 11),
    "Shelf_2": office_shelf(5, 2, "walnut", 12),
    "Shelf_3": office_shelf(3, 2, "oak", 13),
    "Shelf_4": office_shelf(5, 1, "birch", 14),
    "Shelf_5": office_shelf(4, 2, "birch", 15),
    "tak_fenstrar": skylight,
    "whiteboard": board_with_sketch,
}  # fmt: skip


#: pieces with a simple collision shape; the boards of the others are shapes of their own
SOLID = {
    "box": ("IKEA_carpet", "IKEA_chest", "IKEA_cupboard", "cupboard", "office_drawer_block"),
    "convex": ("IKEA_sofa", "IKEA_armchair", "IKEA_bed", "IKEA_Plant", "IKEA_chair_PELLO",
        "IKEA_lamp", "IKEA_RUTBO", "basic_pillow"),
}  # fmt: skip


def catalogue_stock() -> Stock:
    """A stock with the materials that only the catalogue uses."""
    stock = Stock()
    stock.add("shade", lambda: material("Shade", SUN, 0.6, glow=0.8))
    stock.add("sketch", lambda: material("Sketch", "#ffffff", 0.3, image=packed("sketch.png", sketch())))
    return stock


def furniture(
    stock: Stock,
    name: str,
    at: Triple,
    turned: Triple,
    size: Triple,
    centre: Triple,
    collision: str = "",
    **options: Any,
) -> None:
    """A static piece from the catalogue; options as for `common.objects.solid`.

    Args:
        size: of the bounding box in the object's own frame; ``centre`` is its centre.
        collision: its shape; default: that of the catalogue.
    """
    if not collision:
        collision = next((shape for shape, stems in SOLID.items() if name.startswith(stems)), "")
    stem = max((stem for stem in PIECES if name.startswith(stem)), key=len)
    tilted = bool(turned[0] or turned[1])
    frame = np.abs(rotation(*np.degrees(turned))) if tilted else np.eye(3)
    parts = PIECES[stem](stock, *(float(v) for v in frame @ np.array(size)))
    if tilted:  # pieces stand upright in the world, whatever the axes of their object
        parts = in_frame_of(parts, turned)
    low, high = bounds(parts)
    settings = {"physics_type": "STATIC", **({"collision": collision} if collision else {}), **options}
    exact(name, [p.moved(*-(low + high) / 2) for p in parts], size, centre, at, turned, **settings)
