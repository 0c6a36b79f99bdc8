"""A hall with an office at its south end: sixteen desks, a dozen chairs, shelves and a screen on the wall."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import TYPE_CHECKING

from common.catalogue import catalogue_stock, furniture
from common.colors import SKY
from common.images import packed
from common.materials import material
from common.objects import empty, exact, hidden_box, lamp, solid, twin, viewpoint
from common.parts import bounds, in_frame_of
from common.rooms import wall
from common.shapes import box, rectangle, rounded_box
from common.sky import sky
from common.tables import rolling_chair, table
from common.textures import lines, speckle

if TYPE_CHECKING:
    from common.parts import Part
    from common.stock import Stock

#: desks and chairs: bodies, their collision shapes, and their visible meshes
TABLE = Path(__file__).with_suffix(".tsv")
SHELVES = (
    ("Shelf_5", (0.156, -1.77, 0.525), (0, 0, 1.57)),
    ("Shelf_5.001", (0.156, -2.78, 0.525), (0, 0, 1.57)),
    ("Shelf_5.002", (0.15, -3.79, 0.525), (0, 0, 1.57)),
    ("Shelf_5.003", (-0.673, -3.97, 0.525), (0, 0, 0)),
)
WEST, EAST, SOUTH, NORTH, HEIGHT = -6.4, 11.3, -11.0, 4.0, 3.01
TERRACE = (-9.7, -17.8)  # the far corner
TURN = (0, 0, -1.57)
#: m, edges of the terrace around the hall, and of the hole for the floor
OUTSIDE, INSIDE = (-10.0, 13.0, -18.1, 6.2), (-6.387, 11.313, -10.99, 4.01)


def build() -> None:
    sky("#cfdde6")
    lamp("Sun", "SUN", 2.2, (0, -10, 12), (0.6, 0.3, 0.2), color="#fff4e2")
    for number, (x, y) in enumerate(((-2, -12), (6, -12), (-2, -2), (6, -2)), start=1):
        lamp(f"Lamp{number}", "POINT", 220.0, (x, y, 2.8), color="#fff0d6", shadow=False)
    room()
    terrace()
    stock = catalogue_stock()
    for name, at, turned in SHELVES:
        furniture(stock, name, at, turned, (1, 0.4, 1.87), (0.163, -0.049, 0.286), "box")
    desks_and_chairs(stock)
    viewpoint((-4.5, -17.0, 13.0), (2.2, -3.6, 0.0), 21.0)


def room() -> None:
    tiles = speckle(256, "#8f99a3", "#a3adb5", 91) * (1 - 0.18 * lines(256, 2, 0.02)[..., None])
    carpet = material("Carpet", "#99a3ac", 0.95, image=packed("carpet.jpg", tiles))
    still = {"physics_type": "STATIC"}
    floor = in_frame_of([rectangle(17.7, 15).mapped(2.0).painted(carpet)], TURN)
    exact("Floor", floor, (15, 17.7, 0), (-2.22, 0.873, 0), (1.59, -5.71, -0.005), TURN, **still)
    below = [box(18.5, 18.5, 2.75).painted(material("Concrete", "#8b8b88", 0.95))]
    exact("SolidGround", below, (18.5, 18.5, 2.75), (0, 0, 0), (2.89, -4.52, -3), **still)
    plaster = material("Wall", "#efe8da", 0.9, image=packed("plaster.jpg", speckle(256, "#e9e2d4", "#f3eee3", 92)))
    at = (11.3, -6.02, 1.5)
    walls = [part.mapped(2.0).painted(plaster).moved(-at[0], -at[1], -at[2]) for part in outer_walls()]
    exact("Walls1", in_frame_of(walls, TURN), (22, 21.2, 3.01), (0.897, -10.5, 0.007), at, TURN, **still)
    pillar = material("Pillar", "#d8d2c6", 0.8)
    for number, x in enumerate((7.99, 4.2, 0.706)):
        name = f"Pillar1.{number:03}" if number else "Pillar1"
        y = -5.88 if number == 0 else -5.87
        exact(
            name,
            [rounded_box(0.171, 0.197, 3, 0.02, 1).painted(pillar)],
            (0.171, 0.197, 3),
            (0, 0, 0),
            (x, y, 1.5),
            TURN,
            **still,
        )
    shown = (1.57, 0, 0.001)
    screen = [
        rounded_box(1.4, 0.098, 0.7, 0.03, 2).painted(material("Bezel", "#14181d", 0.4)),
        box(1.32, 0.01, 0.62).moved(0, -0.05, 0).painted(material("Display", SKY, 0.2, glow=0.8)),
    ]
    screen = in_frame_of(screen, shown)
    at, centre = (4.96, 0.556, 1.23), (0, 0, 0.062)
    exact("TV_screen", screen, (1.4, 0.7, 0.098), centre, at, shown, physics_type="NO_COLLISION")


def terrace() -> None:
    """Slabs around the hall, as high as its floor, with a parapet: a robot that leaves the hall does not fall."""
    paving = speckle(256, "#a8a196", "#b9b2a6", 93) * (1 - 0.14 * lines(256, 4, 0.02)[..., None])
    slab = material("Paving", "#b0a99d", 0.95, image=packed("paving.jpg", paving))
    coping = material("Parapet", "#d9d2c4", 0.9)
    (x0, x1, y0, y1), (u0, u1, v0, v1) = OUTSIDE, INSIDE
    still = {"physics_type": "STATIC", "collision": "box"}
    for name, west, east, south, north in (
        ("South", x0, x1, y0, v0),
        ("North", x0, x1, v1, y1),
        ("West", x0, u0, v0, v1),
        ("East", u1, x1, v0, v1),
    ):
        parts = [box(east - west, north - south, 0.2).mapped(2.0).painted(slab)]
        solid(f"Terrace{name}", parts, ((west + east) / 2, (south + north) / 2, -0.105), **still)
    for name, long, at, turn in (
        ("South", x1 - x0, ((x0 + x1) / 2, y0 + 0.1, 0.45), 0.0),
        ("North", x1 - x0, ((x0 + x1) / 2, y1 - 0.1, 0.45), 0.0),
        ("West", y1 - y0, (x0 + 0.1, (y0 + y1) / 2, 0.45), 1.57),
        ("East", y1 - y0, (x1 - 0.1, (y0 + y1) / 2, 0.45), 1.57),
    ):
        solid(f"Parapet{name}", [box(long, 0.2, 1.0, 0.02).painted(coping)], at, (0, 0, turn), **still)


def outer_walls() -> list[Part]:
    """The walls of the hall, and a pergola in front of its west and south side."""
    thick = 0.2
    windows = tuple((2.0 + 4.2 * k, 4.6 + 4.2 * k, 0.9, 2.3) for k in range(3))
    parts = wall((WEST, SOUTH), (EAST, SOUTH), ((1.0, 2.6, 0.0, 2.2), *windows[1:]), thick, HEIGHT)
    parts += wall((WEST, NORTH), (EAST, NORTH), ((8.0, 9.6, 0.0, 2.2),), thick, HEIGHT)
    for x in (WEST, EAST):
        parts += wall((x, SOUTH + thick), (x, NORTH - thick), windows, thick, HEIGHT)
    parts += wall((2.2, 0.72), (7.7, 0.72), (), thick, 2.4)  # carries the screen
    x, y = TERRACE
    posts = [(x, y), (x, SOUTH), (x, NORTH), (0.8, y), (EAST, y)]
    parts += [box(0.2, 0.2, HEIGHT - 0.15).moved(u, v, (HEIGHT - 0.15) / 2) for u, v in posts]
    top = HEIGHT - 0.075
    parts.append(box(EAST - x + 0.2, 0.2, 0.15).moved((EAST + x) / 2, y, top))
    parts.append(box(0.2, NORTH - y - 0.1, 0.15).moved(x, (NORTH + y) / 2 + 0.15, top))
    for k in range(1, 9):
        u = x + (EAST - x) * k / 8
        parts.append(box(0.08, SOUTH - y - 0.2, 0.12).moved(u, (SOUTH + y) / 2, top))
    return parts


def desks_and_chairs(stock: Stock) -> None:
    with TABLE.open(newline="") as file:
        rows = list(csv.DictReader(file, delimiter="\t"))
    made: dict[str, object] = {}
    first: dict[str, object] = {}
    for row in rows:
        name = row["name"]
        at, turned = (tuple(float(v) for v in row[key].split()) for key in ("xyz", "rpy"))
        parent = made.get(row["parent"])
        if not row["size"]:
            body = {"physics_type": "RIGID_BODY", "collision": "convex", "compound": 1, "mass": float(row["mass"])}
            made[name] = empty(name, at, turned, **body)
            continue
        size, centre = (tuple(float(v) for v in row[key].split()) for key in ("size", "centre"))
        if "_mes" not in name:
            hidden_box(name, size, at, turned, parent=parent, physics_type="RIGID_BODY", mass=float(row["mass"]))
            continue
        kind = name.split("_mes")[0]
        if kind in first:
            twin(first[kind], name, at, turned, parent=parent, physics_type="NO_COLLISION")
            continue
        parts = desk(stock) if kind == "Desk_3" else [p.turned(z=180) for p in rolling_chair(stock, 0.6, 0.63, 0.93)]
        low, high = bounds(parts)
        parts = [p.moved(*-(low + high) / 2) for p in parts]
        first[kind] = exact(name, parts, size, centre, at, turned, parent=parent, physics_type="NO_COLLISION")


def desk(stock: Stock) -> list[Part]:
    return table(stock, 1.6, 0.802, 0.733, "birch", "birch")
