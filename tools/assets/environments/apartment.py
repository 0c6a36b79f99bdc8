"""A furnished flat of four rooms, with an office in front of its door."""

from __future__ import annotations

from typing import TYPE_CHECKING

from common.catalogue import catalogue_stock, furniture
from common.images import packed
from common.materials import material
from common.objects import empty, exact, hidden_box, lamp, viewpoint
from common.rooms import wall
from common.shapes import rectangle
from common.sky import sky
from common.storage import shelf
from common.textures import planks, speckle

if TYPE_CHECKING:
    from common.parts import Part
    from common.stock import Stock

#: name, position, Euler XYZ, size and centre of the bounding box, collision shape
PIECES = (
    ("IKEA_armchair_EKTORP", (-4.41, 0.967, 0), (0, 0, 0.422), (0.8, 0.7, 0.77), (0, 0.006, 0.385), ""),
    ("IKEA_armchair_EKTORP.001", (-2.93, -1.39, 0), (0, 0, -2.74), (0.8, 0.7, 0.77), (0, 0.006, 0.385), ""),
    ("IKEA_bed_FJELLSE", (-4.56, 4.09, 0), (0, 0, 1.57), (1.01, 2.07, 0.8), (0.009, 0.017, 0.4), ""),
    ("IKEA_carpet_DRAGOR", (-3.71, -0.111, 0), (0, 0, 0.726), (2, 3, 0.01), (0, 0, 0), ""),
    ("IKEA_chair_PELLO", (-0.071, 5.46, 0), (0, 0, -0.294), (0.67, 0.85, 0.96), (0.002, -0.021, 0.48), ""),
    ("IKEA_chair_PELLO.001", (-1.06, 4.73, 0), (0, 0, 1.76), (0.67, 0.85, 0.96), (0.002, -0.021, 0.48), ""),
    ("IKEA_chair_STEFAN", (0.848, 4.67, 0), (0, 0, 0), (0.42, 0.49, 0.9), (0, 0.037, 0.449), ""),
    ("IKEA_chair_STEFAN.001", (0.287, 3.74, 0), (0, 0, 1.97), (0.42, 0.49, 0.9), (0, 0.037, 0.449), ""),
    ("IKEA_chest_HEMNES", (-1.95, 4.06, 0), (0, 0, -1.57), (1.1, 0.518, 0.97), (0, -0.005, 0.486), ""),
    ("IKEA_console_HEMNES", (-3.46, 5.79, 0), (0, 0, 0), (1.59, 0.4, 0.74), (0, 0, 0.37), ""),
    ("IKEA_cupboard_BILLY_1", (-5.24, 2.14, 0), (0, 0, 3.14), (0.8, 0.28, 2.02), (-0.001, 0, 1.01), ""),
    ("IKEA_cupboard_BILLY_2", (-1.45, 3.95, 0), (0, 0, 1.57), (0.4, 0.309, 1.06), (0, -0.015, 0.53), ""),
    ("IKEA_cupboard_BILLY_3", (-1.45, 3.33, 0), (0, 0, 1.57), (0.8, 0.317, 1.06), (-0.001, -0.019, 0.53), ""),
    ("IKEA_lamp_orgel", (-3.83, -1.73, 0), (0, 0, 0), (0.245, 0.245, 1.54), (0, 0, 0.771), ""),
    ("IKEA_low_table_LACK_1", (-1.28, 5.69, 0), (0, 0, 0), (0.55, 0.55, 0.45), (0, 0, 0.225), ""),
    ("IKEA_low_table_LACK_1.001", (-5.15, 4.91, 0), (0, 0, 0), (0.55, 0.55, 0.45), (0, 0, 0.225), ""),
    ("IKEA_low_table_LACK_2", (-3.75, -0.1, 0), (0, 0, 0.659), (0.55, 0.899, 0.45), (0, -0.013, 0.225), ""),
    ("IKEA_Plant_1", (-4.95, -1.71, 0), (0, 0, 0), (0.652, 0.619, 1.66), (0.022, 0.014, 0.828), ""),
    ("IKEA_Plant_2", (0.831, 2.63, 0), (0, 0, 0), (0.998, 0.742, 1.05), (0.002, 0.016, 0.526), ""),
    ("IKEA_RUTBO", (-1.29, 5.69, 0.459), (0, 0, 0), (0.3, 0.255, 1.14), (0, 0, 0.571), ""),
    ("IKEA_sofa_EKTORP", (-4.7, -0.934, 0), (0, 0, 2.28), (1.79, 0.88, 0.951), (0, -0.059, 0.475), ""),
    ("IKEA_table_TORSBY", (0.94, 3.89, 0), (0, 0, 1.57), (1.35, 0.85, 0.75), (0, 0, 0.375), ""),
    ("office_desk", (0.232, -2.74, 0.028), (0, 0, 0), (1.6, 0.802, 0.731), (0, 0.001, 0.366), ""),
    ("office_desk.001", (1.86, -2.73, 0.028), (0, 0, 0), (1.6, 0.802, 0.731), (0, 0.001, 0.366), ""),
    ("office_desk.002", (2.27, -1.52, 0.028), (0, 0, 1.57), (1.6, 0.802, 0.731), (0, 0.001, 0.366), ""),
    ("office_desk.003", (2.27, 0.088, 0.028), (0, 0, 1.57), (1.6, 0.802, 0.731), (0, 0.001, 0.366), ""),
    ("office_drawer_block", (2.25, 0.329, 0), (0, 0, 0), (0.609, 0.43, 0.558), (0.009, 0, 0.281), ""),
    ("office_drawer_block.001", (-0.191, -2.74, 0), (0, 0, -1.57), (0.609, 0.43, 0.558), (0.009, 0, 0.281), ""),
)  # fmt: skip
WEST, EAST, SOUTH, NORTH = -5.75, 1.45, -2.195, 6.075
THICK, HEIGHT = 0.15, 2.5
#: from, to, and the openings: start and end along the wall, lower and upper edge
WALLS = (
    ((WEST, SOUTH), (EAST, SOUTH), ((5.3, 6.3, 0.0, 2.1), (1.2, 2.8, 0.9, 2.1))),
    ((WEST, NORTH), (EAST, NORTH), ((0.9, 1.6, 0.9, 2.1), (4.9, 6.3, 0.9, 2.1))),
    ((WEST, SOUTH + THICK), (WEST, NORTH - THICK), ((1.35, 2.85, 0.9, 2.1), (5.25, 6.85, 0.9, 2.1))),
    ((EAST, SOUTH + THICK), (EAST, NORTH - THICK), ((0.65, 2.25, 0.9, 2.1), (5.15, 6.85, 0.9, 2.1))),
    ((WEST + THICK, 1.93), (-0.55, 1.93), ((3.0, 3.9, 0.0, 2.1),)),
    ((0.45, 1.93), (EAST - THICK, 1.93), ()),
    ((-1.66, 1.93 + THICK), (-1.66, NORTH - THICK), ((2.8, 3.7, 0.0, 2.1),)),
)


def build() -> None:
    sky("#cfdde6")
    lamp("Sun", "SUN", 2.6, (4, -8, 10), (0.7, 0.25, 0.3), color="#fff1d8")
    for number, (x, y) in enumerate(((-3.7, 0.0), (-3.7, 4.2), (0.0, 0.2), (0.0, 4.2)), start=1):
        lamp(f"Lamp{number}", "POINT", 120.0, (x, y, 2.3), color="#ffe9c8", shadow=False)
    floor = material("Floor", "#c79a6a", 0.5, image=packed("floor.jpg", planks(512, "#b98a58", "#d6ab79", 8, seed=81)))
    exact(
        "Plane",
        [rectangle(21.8, 21.8).mapped(1.6).painted(floor)],
        (21.8, 21.8, 0),
        (0, 0, 0),
        (0, 0, -0.017),
        physics_type="STATIC",
    )
    paint = material("Wall", "#f1eadb", 0.9, image=packed("plaster.jpg", speckle(256, "#ece5d6", "#f4efe4", seed=82)))
    at = (-5.21, -2.16, 1.25)
    walls: list[Part] = [p.mapped(2.0).painted(paint) for line in WALLS for p in wall(*line, THICK, HEIGHT)]
    walls = [p.moved(-at[0], -at[1], -at[2]) for p in walls]
    exact("C6_plein_ext_P", walls, (7.2, 8.27, 2.5), (3.06, 4.1, 0), at, physics_type="STATIC")
    stock = catalogue_stock()
    for piece in PIECES:
        furniture(stock, *piece)
    shelves(stock)
    viewpoint((5.2, -8.2, 9.4), (-1.7, 1.0, 0.0), 23.0)


def shelves(stock: Stock) -> None:
    """Three boxes that make one piece of furniture."""
    root = empty("IKEAShelf", (-4.26, -3.16, 0), physics_type="RIGID_BODY", collision="convex", compound=1, mass=1.0)
    hidden_box(
        "IKEAShelf_bb",
        (0.827, 0.85, 0.788),
        (-4.26, -3.16, 0.399),
        (0, 0, -2.4),
        parent=root,
        physics_type="RIGID_BODY",
        mass=5.6,
    )
    places = ((-4.31, -2.33, 0), (-3.51, -2.33, 0), (-4.31, -2.33, 0.79))
    for number, at in enumerate(places):
        parts = [
            p.turned(z=90) for p in shelf(stock, 0.79, 0.398, 0.79, rows=2, columns=2, wood="walnut", books=number)
        ]
        suffix = f".{number:03}" if number else ""
        exact(
            f"IKEAShelf_mesh{suffix}",
            parts,
            (0.398, 0.79, 0.79),
            (0.001, 0, 0.395),
            at,
            (0, 0, 1.57),
            parent=root,
            physics_type="NO_COLLISION",
        )
