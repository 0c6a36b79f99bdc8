"""A room with drawers, doors and shelves to open, and a winding path outside to practise walking."""

from __future__ import annotations

import itertools
import re
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from common.images import packed
from common.materials import material
from common.measured import Furnisher, rows
from common.objects import lamp, viewpoint
from common.rooms import panes, trim, wall
from common.shapes import box, cylinder, rectangle, rounded_box
from common.sky import sky
from common.stock import Stock
from common.storage import shelf
from common.tables import chair, rolling_chair, table
from common.tableware import cup
from common.textures import planks, speckle

if TYPE_CHECKING:
    from collections.abc import Callable

    from common.measured import Row
    from common.parts import Part

BOXES = frozenset(("chair", "door", "drawer", "rolling chair"))
TABLE = Path(__file__).with_suffix(".tsv")
#: m, centres of the walls; openings along them: from, to, lower and upper edge
WEST, EAST, SOUTH, NORTH, HEIGHT, THICK = -3.91, 3.91, -5.9, 5.9, 2.5, 0.2
WINDOWS = ((1.6, 3.4, 0.9, 2.1), (4.6, 6.4, 0.9, 2.1))
DOORWAY = (5.1, 6.7, 0.0, 2.1)
#: the centre line of the path, relative to the centre of its bounding box; m
TRAIL = ((-15.8, 9.8), (14.8, 9.8), (14.8, 3.3), (-12.0, 3.3), (-12.0, -3.3), (14.8, -3.3), (14.8, -9.8), (-14.8, -9.8))
WIDE, DEEP, RAIL = 2.0, 0.91, 0.61


def build() -> None:
    sky("#cfe0ec")
    lamp("Sun", "SUN", 2.4, (6, -8, 12), (0.7, 0.3, 0.3), color="#fff1dc")
    for number, y in enumerate((-3.0, 3.0), start=1):
        lamp(f"Lamp{number}", "POINT", 140.0, (0, y, 2.3), color="#fff0d8", shadow=False)
    Furnisher(Room().look, BOXES).furnish(list(rows(TABLE)))
    viewpoint((6.5, -9.0, 7.0), (-0.3, -0.6, 0.3), 20.0)


class Room:
    """The appearance of each object, by its name."""

    def __init__(self) -> None:
        self.stock = stock = Stock()
        floor = planks(256, "#a9825a", "#c59d70", 6, seed=33)
        meadow = speckle(256, "#6f8f52", "#86a565", seed=12)
        plaster = speckle(256, "#efe9dc", "#f7f3ea", seed=82)
        for name, color, picture in (
            ("boards", "#b98f63", floor),
            ("meadow", "#7a9a5a", meadow),
            ("plaster", "#f3eee3", plaster),
        ):
            stock.add(name, partial(_pictured, name, color, picture))
        self._looks: tuple[tuple[str, str, Callable[[Row], list[Part]]], ...] = (
            (r"Chair$", "chair", lambda row: chair(stock, *row.size, "oak", "teal")),
            (r"Chair2", "rolling chair", lambda row: rolling_chair(stock, *row.size)),
            (r"CubeSelect", "cup", lambda row: cup(stock["coral"])),
            (r"Desk_1", "desk", lambda row: table(stock, *row.size, "birch", "steel")),
            (r"Drawers$", "drawers", lambda row: shelf(stock, *row.size, rows=7, columns=3, wood="oak", books=None)),
            (r"Drawers_Door", "door", lambda row: self.sliding(row)),
            (r"Drawers_Drawer", "drawer", lambda row: self.drawer(row)),
            (r"Ground", "floor", lambda row: [rectangle(*row.size[:2]).mapped(1.6).painted(stock["boards"])]),
            (r"restarter", "meadow", lambda row: [rectangle(*row.size[:2]).mapped(4.0).painted(stock["meadow"])]),
            (r"SerpentsTrail", "trail", lambda row: self.trail()),
            (r"Shelf$", "shelf", lambda row: self.facing_x(row)),
            (r"Shelf2", "bookcase", lambda row: shelf(stock, *row.size, rows=5, wood="walnut", books=4)),
            (r"Shelf_.*Door", "leaf", lambda row: self.leaf(row)),
            (r"Table", "table", lambda row: table(stock, *row.size, "oak", "oak")),
            (r"Walls", "walls", lambda row: self.walls()),
        )

    def look(self, row: Row) -> tuple[str, Callable[[], list[Part]]]:
        """A word for its appearance, and a function that makes it."""
        for pattern, word, make in self._looks:
            if re.match(pattern, row.name):
                return word, partial(make, row)
        raise LookupError(f"there is no appearance for '{row.name}'")

    def walls(self) -> list[Part]:
        """Four walls: windows in the west, and a doorway in the east, from which the path leads away."""
        stock = self.stock
        parts: list[Part] = []
        for start, end, openings in (
            ((WEST, SOUTH), (WEST, NORTH), WINDOWS),
            ((EAST, SOUTH), (EAST, NORTH), (DOORWAY,)),
            ((WEST, SOUTH), (EAST, SOUTH), ()),
            ((WEST, NORTH), (EAST, NORTH), ()),
        ):
            parts += [p.mapped(2.0).painted(stock["plaster"]) for p in wall(start, end, openings, THICK, HEIGHT)]
            skirting, frames = trim(start, end, openings, THICK) if openings is WINDOWS else ([], [])
            parts += [p.painted(stock["white"]) for p in (*skirting, *frames)]
            if openings is WINDOWS:
                parts += [p.painted(stock["glass"]) for p in panes(start, end, openings, 0.012)]
        return parts

    def trail(self) -> list[Part]:
        """Slabs between two rails; the rails end where the path turns."""
        stock, parts = self.stock, []
        for (x0, y0), (x1, y1) in itertools.pairwise(TRAIL):
            long, wide = abs(x1 - x0) + WIDE, abs(y1 - y0) + WIDE
            if (x0, y0) == TRAIL[0] or (x1, y1) == TRAIL[-1]:
                long -= WIDE / 2
            across = (x0 + x1) / 2 + (WIDE / 4 if (x0, y0) == TRAIL[0] else -WIDE / 4 if (x1, y1) == TRAIL[-1] else 0)
            middle = (across, (y0 + y1) / 2)
            along = y0 == y1
            size = (long, WIDE) if along else (WIDE, wide - 2 * WIDE)
            parts.append(box(*size, DEEP).moved(*middle, -DEEP / 2).mapped(2.0).painted(stock["stone"]))
            for side in (1, -1):
                if along:
                    rail = box(long - 2 * WIDE - 0.2, 0.06, 0.08).moved(middle[0], middle[1] + side * (WIDE / 2 - 0.03))
                    posts = [middle[0] + k * (long - 2 * WIDE - 0.4) / 6 for k in range(-3, 4)]
                    parts += [
                        box(0.06, 0.06, RAIL - 0.04)
                        .moved(x, middle[1] + side * (WIDE / 2 - 0.03), RAIL / 2 - 0.02)
                        .painted(stock["steel"])
                        for x in posts
                    ]
                    parts.append(rail.moved(z=RAIL - 0.04).painted(stock["coral"]))
        return parts

    def facing_x(self, row: Row) -> list[Part]:
        """Shelves whose doors are separate objects."""
        x, y, z = row.size
        return [part.turned(z=90) for part in shelf(self.stock, y, x, z, rows=5, columns=2, wood="walnut", books=7)]

    def sliding(self, row: Row) -> list[Part]:
        """A thin panel with a round handle."""
        x, y, z = row.size
        panel = box(x, min(y, 0.02), z).painted(self.stock["birch"])
        grip = cylinder(0.025, y * 1.02, columns=20).turned(x=90).moved(x * 0.38, 0, 0).painted(self.stock["steel"])
        return [panel, grip]

    def leaf(self, row: Row) -> list[Part]:
        """A door with a handle on the side that opens, facing X."""
        x, y, z = row.size
        side = 1 if row.centre[1] >= 0 else -1
        grip = box(x - 0.025, 0.02, 0.14).moved(0.0125, side * y * 0.4, 0)
        return [
            rounded_box(0.025, y, z, 0.006, 1).moved(-(x - 0.025) / 2).painted(self.stock["birch"]),
            grip.painted(self.stock["steel"]),
        ]

    def drawer(self, row: Row) -> list[Part]:
        """A box that is open at the top, with a front and a handle, facing -Y."""
        x, y, z = row.size
        thin, bar = 0.012, 0.03
        inner = y - bar - 0.02
        parts = [box(x - 0.04, inner, thin).moved(0, bar / 2 + 0.01, -z / 2 + 0.02)]
        parts += [box(thin, inner, z * 0.7).moved(s * (x / 2 - 0.026), bar / 2 + 0.01, -z * 0.1) for s in (1, -1)]
        parts += [box(x - 0.04, thin, z * 0.7).moved(0, y / 2 - thin / 2, -z * 0.1)]
        front = rounded_box(x, 0.02, z, 0.004, 1).moved(0, -y / 2 + bar + 0.01, 0)
        grip = [box(x * 0.4, 0.012, 0.012).moved(0, -y / 2 + 0.006, 0)]
        grip += [box(0.012, bar, 0.012).moved(s * x * 0.18, -y / 2 + bar / 2, 0) for s in (1, -1)]
        return [
            *(part.painted(self.stock["white"]) for part in parts),
            front.painted(self.stock["birch"]),
            *(part.painted(self.stock["steel"]) for part in grip),
        ]


def _pictured(name: str, color: str, picture: object) -> object:
    return material(name.title(), color, 0.85, image=packed(f"{name}.jpg", picture))
