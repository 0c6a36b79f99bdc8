"""A kitchen for fetching and cooking: an island, an oven, a sink, a fridge, and desks along the walls."""

from __future__ import annotations

import re
from dataclasses import replace
from functools import partial
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING

from common.household import radiator
from common.images import packed
from common.materials import material
from common.measured import Furnisher, rows
from common.objects import lamp, solid, viewpoint
from common.posters import hello
from common.rooms import panes, trim, wall
from common.shapes import box, cylinder, rectangle, rounded_box, tube
from common.sky import sky
from common.stock import Stock
from common.storage import cupboard, shelf
from common.tables import chair, table
from common.textures import lines, planks, speckle

if TYPE_CHECKING:
    from collections.abc import Callable

    from common.measured import Row
    from common.parts import Part

BOXES = frozenset(
    ("chair", "computer", "door", "drawer", "front", "hob", "house door", "keyboard", "monitor", "radiator", "tap")
)
TABLE = Path(__file__).with_suffix(".tsv")
#: m, inner faces of the walls of the room, and the height of the ceiling
WEST, EAST, SOUTH, NORTH, HEIGHT = 0.0, 6.95, -3.06, 8.74, 2.72
#: windows above the radiators: from, to, lower and upper edge
WINDOWS = tuple((x, x + 1.35, 0.95, 2.3) for x in (0.2, 1.95, 3.7, 5.4))
#: m, ends of the passage behind the double door
PASSAGE = (-3.29, 9.01)
DOUBLE_DOOR = (1.385, 3.555, 0.0, 2.64)


def build() -> None:
    sky("#d6e2ea")
    lamp("Sun", "SUN", 2.2, (4, -8, 10), (0.75, 0.25, 0.3), color="#fff1dc")
    for number, (x, y) in enumerate(((2, 0), (5.3, 0), (2, 5.8), (5.3, 5.8)), start=1):
        lamp(f"Lamp{number}", "POINT", 160.0, (x, y, 2.5), color="#fff0d8", shadow=False)
    furniture = list(rows(TABLE))
    desks = [row for row in furniture if row.name.startswith("Desk")]
    Furnisher(Kitchen().look, BOXES).furnish([*furniture, *map(rest_of, desks)])
    passage()
    viewpoint((7.6, -4.6, 6.4), (2.6, 2.6, 0.2), 20.0)


def rest_of(desk: Row) -> Row:
    """Return the other three quarters of a desk: the desk of the table is the one at -X and +Y of its origin."""
    assert desk.size is not None
    x, y, z = desk.size
    name = desk.name.replace("Desk", "Desk_Rest")
    return replace(desk, name=name, size=(2 * x, 2 * y, z), centre=(0.0, 0.0, z / 2), options=dict(desk.options))


def passage() -> None:
    """A parapet along the open side of the passage, at the edge of the floor: no robot falls off."""
    low, high = PASSAGE
    parts = [box(0.14, high - low, 1.0, 0.015).painted(material("Parapet", "#e7e0d2", 0.9))]
    parts += [box(0.2, high - low, 0.04, 0.01).moved(0, 0, 0.52).painted(material("Coping", "#b98a5b", 0.6))]
    at = (8.135, (low + high) / 2, 0.5)
    solid("Parapet", parts, at, physics_type="STATIC", collision="box")


class Kitchen:
    """The appearance of each object, by its name."""

    def __init__(self) -> None:
        self.stock = stock = Stock()
        stock.add("tiles", lambda: _pictured("Tiles", "#c9ccc8", _tiles()))
        stock.add("plaster", lambda: _pictured("Plaster", "#f3eee3", speckle(256, "#efe9dc", "#f7f3ea", seed=82)))
        stock.add("worktop", lambda: _pictured("Worktop", "#c79a6a", planks(256, "#b1814f", "#cf9d69", 6, seed=21)))
        stock.add("greeting", lambda: _pictured("Greeting", "#ffffff", hello()))
        stock.add("hob", lambda: material("Hob", "#101418", 0.08))
        self._looks: tuple[tuple[str, str, Callable[[Row], list[Part]]], ...] = (
            (r"Board2?$", "wardrobe", lambda row: self.wardrobe(row)),
            (r"(Board|Cabinet).*Door", "door", lambda row: self.front(row)),
            (r"Cabinet$", "cabinet", lambda row: self.facing_x(row, cupboard, 1, "birch", "birch")),
            (r"Chair", "chair", lambda row: self.standing(row, chair, "oak", "coral")),
            (r"Compass$", "compass", lambda row: self.compass()),
            (r"Cube$", "low wall", lambda row: [box(*row.size).mapped(2.0).painted(stock["plaster"])]),
            (r"Cube\.001", "bottom", lambda row: [box(*row.size).painted(stock["steel"])]),
            (r"Desk_Rest", "rest of desk", lambda row: self.three_quarters(row)),
            (r"Desk", "desk", lambda row: self.standing(row, table, "birch", "steel")),
            (r"Door\.[LR]", "house door", lambda row: self.leaf(row)),
            (r"Door_Frame$", "frame", lambda row: self.frame(row)),
            (r"Door_Frame_Glass", "pane", lambda row: [box(*row.size).painted(stock["glass"])]),
            (r"ground$", "floor", lambda row: [rectangle(*row.size[:2]).mapped(2.4).painted(stock["tiles"])]),
            (r"Keyboard", "keyboard", lambda row: self.keyboard(row)),
            (r"Monitor", "monitor", lambda row: self.monitor(row)),
            (r"PC", "computer", lambda row: self.computer(row)),
            (r"Pillar", "pillar", lambda row: [box(*row.size).mapped(2.0).painted(stock["plaster"])]),
            (r"Poster", "poster", lambda row: [self.poster(row)]),
            (r"Radiator", "radiator", lambda row: radiator(stock, *row.size)),
            (r"Table_Small", "side table", lambda row: self.standing(row, table, "walnut", "walnut")),
            (r"tap", "tap", lambda row: self.tap()),
            (r"v1\.node(10\.|61\.visual\.door|67\.)", "door", lambda row: self.front(row)),
            (r"v1\.node(12|61)\.visual$", "body", lambda row: self.body(row)),
            (r"v1\.node3\.", "fridge", lambda row: self.body(row)),
            (r"v1\.node16\.", "island", lambda row: self.body(row)),
            (r"v1\.node(17|73)\.", "worktop", lambda row: [self.top(row, "worktop")]),
            (r"v1\.node46\.", "hob", lambda row: self.hob(row)),
            (r"v1\.node(47|48|49)\.", "shelf", lambda row: [self.top(row, "oak")]),
            (r"v1\.node50\.", "walls", lambda row: self.walls()),
            (r"v1\.node51\.", "pier", lambda row: [box(*row.size).mapped(2.0).painted(stock["plaster"])]),
            (r"v1\.node(55|64|84|87)\.", "front", lambda row: self.front(row)),
            (r"v1\.node92\.", "sink", lambda row: self.sink(row)),
            (r"v1\.node(53|69|71|72|93)\.", "panel", lambda row: [box(*row.size, 0.003).painted(stock["white"])]),
            (r"v1\.node", "drawer", lambda row: self.drawer(row)),
        )

    def look(self, row: Row) -> tuple[str, Callable[[], list[Part]]]:
        """A word for its appearance, and a function that makes it."""
        for pattern, word, make in self._looks:
            if re.match(pattern, row.name):
                return word, partial(make, row)
        raise LookupError(f"there is no appearance for '{row.name}'")

    # -- the room ----------------------------------------------------------------------------

    def walls(self) -> list[Part]:
        """Four walls; windows to the south and north, a double door to a passage in the east."""
        stock, thin, thick = self.stock, 0.05, 0.23
        door = (DOUBLE_DOOR[0] - SOUTH, DOUBLE_DOOR[1] - SOUTH, *DOUBLE_DOOR[2:])
        lines_ = (
            ((WEST, SOUTH - thick / 2), (8.065, SOUTH - thick / 2), WINDOWS, thick),
            ((WEST, NORTH + 0.135), (8.065, NORTH + 0.135), WINDOWS, 0.27),
            ((WEST + thin / 2, SOUTH), (WEST + thin / 2, NORTH), (), thin),
            ((EAST + 0.15, SOUTH), (EAST + 0.15, NORTH), (door,), 0.3),
        )
        parts: list[Part] = []
        for start, end, openings, width in lines_:
            parts += [p.mapped(2.0).painted(stock["plaster"]) for p in wall(start, end, openings, width, HEIGHT)]
            skirting, frames = trim(start, end, openings, width) if width > thin and openings is WINDOWS else ([], [])
            parts += [p.painted(stock["white"]) for p in (*skirting, *frames)]
            parts += [p.painted(stock["glass"]) for p in panes(start, end, openings, 0.012)]
        return parts

    def frame(self, row: Row) -> list[Part]:
        """Two posts and a lintel that leave the way free."""
        deep, wide, high = row.size
        post = (wide - 2.0) / 2
        parts = [box(deep, post, high).moved(0, s * (wide - post) / 2, high / 2) for s in (1, -1)]
        parts += [box(deep, wide - 2 * post, 0.07).moved(0, 0, high - 0.035)]
        parts += [box(deep * 0.5, wide - 2 * post, 0.05).moved(0, 0, 2.14)]
        return [p.painted(self.stock["white"]) for p in parts]

    def leaf(self, row: Row) -> list[Part]:
        """A door with two panels and a handle on both sides."""
        deep, wide, high = 0.045, row.size[1], row.size[2]
        side = 1 if row.centre[1] > 0 else -1
        parts = [box(deep, wide, high, 0.004).painted(self.stock["teal"])]
        parts += [
            box(deep + 0.008, wide * 0.7, high * 0.38, 0.004).moved(0, 0, z).painted(self.stock["cream"])
            for z in (-high * 0.24, high * 0.24)
        ]
        grips = [box(0.01, 0.12, 0.02).moved(x, side * wide * 0.4, 0) for x in (-row.size[0] / 2, row.size[0] / 2)]
        return [*parts, *(grip.painted(self.stock["steel"]) for grip in grips)]

    def poster(self, row: Row) -> Part:
        return rectangle(*row.size[:2]).stretched_over((0, 1)).painted(self.stock["greeting"])

    # -- furniture ---------------------------------------------------------------------------

    def standing(self, row: Row, make: Callable[..., list[Part]], *words: str) -> list[Part]:
        return make(self.stock, *row.size, *words)

    def three_quarters(self, row: Row) -> list[Part]:
        """Tables at the front and at the right rear."""
        x, y, z = row.size
        front = [part.moved(0, -y / 4) for part in table(self.stock, x, y / 2, z, "birch", "steel")]
        rear = [part.moved(x / 4, y / 4) for part in table(self.stock, x / 2, y / 2, z, "birch", "steel")]
        return [*front, *rear]

    def facing_x(self, row: Row, make: Callable[..., list[Part]], *words: object) -> list[Part]:
        """A piece whose front faces X."""
        x, y, z = row.size
        return [part.turned(z=90) for part in make(self.stock, y, x, z, *words)]

    def wardrobe(self, row: Row) -> list[Part]:
        """Open, with shelves: its doors are separate objects."""
        return [
            part.turned(z=90) for part in shelf(self.stock, row.size[1], row.size[0], row.size[2], rows=5, columns=3)
        ]

    def body(self, row: Row) -> list[Part]:
        """A cupboard with openings for drawers and doors, facing X."""
        x, y, z = row.size
        parts = [box(0.02, y, z).moved(-(x - 0.02) / 2, 0, 0)]
        parts += [box(x, 0.02, z).moved(0, s * (y - 0.02) / 2, 0) for s in (1, -1)]
        parts += [box(x, y, 0.02).moved(0, 0, s * (z - 0.02) / 2) for s in (1, -1)]
        return [part.painted(self.stock["white"]) for part in parts]

    def front(self, row: Row) -> list[Part]:
        """A door of a cupboard with its handle on the side that opens."""
        x, y, z = row.size
        thick = min(0.022, x * 0.6)
        side = 1 if row.centre[1] >= 0 else -1
        panel = rounded_box(thick, y, z, 0.004, 1).painted(self.stock["birch"])
        grip = tube([(thick / 2 + 0.02, side * y * 0.4, s * min(0.12, z * 0.2)) for s in (-1, 1)], 0.006, 8)
        ends = [
            box(0.02, 0.012, 0.012).moved(thick / 2 + 0.01, side * y * 0.4, s * min(0.11, z * 0.18)) for s in (-1, 1)
        ]
        return [panel, *(part.painted(self.stock["steel"]) for part in (grip, *ends))]

    def drawer(self, row: Row) -> list[Part]:
        """A box that is open at the top, with a front and a bar handle, facing X."""
        x, y, z = row.size
        wall_, bar = 0.012, 0.035
        deep, high = x - bar, z * 0.7
        parts = [rounded_box(0.02, y, z, 0.004, 1).moved(deep / 2 - 0.01).painted(self.stock["birch"])]
        inner = [box(deep - 0.02, y - 0.04, wall_).moved(-0.01, 0, -z / 2 + 0.02)]
        inner += [
            box(deep - 0.02, wall_, high).moved(-0.01, s * (y / 2 - 0.026), -(z - high) / 2 + 0.02) for s in (1, -1)
        ]
        inner += [box(wall_, y - 0.04, high).moved(-deep / 2 + wall_, 0, -(z - high) / 2 + 0.02)]
        grip = tube([(deep / 2 + bar - 0.006, s * y * 0.3, 0) for s in (-1, 1)], 0.006, 8)
        ends = [box(bar, 0.012, 0.012).moved(deep / 2 + bar / 2 - 0.006, s * y * 0.28, 0) for s in (-1, 1)]
        return [
            *parts,
            *(part.painted(self.stock["white"]) for part in inner),
            *(part.painted(self.stock["steel"]) for part in (grip, *ends)),
        ]

    def top(self, row: Row, wood: str) -> Part:
        x, y, z = row.size
        return box(x, y, z, 0.003).mapped(0.8).painted(self.stock[wood])

    def hob(self, row: Row) -> list[Part]:
        x, y, z = row.size
        rings = [
            cylinder(0.07 + 0.02 * (k % 2), z * 0.2, columns=28).moved(u * x * 0.24, v * y * 0.24, z * 0.5)
            for k, (u, v) in enumerate(product((1, -1), repeat=2))
        ]
        return [box(x, y, z).painted(self.stock["hob"]), *(ring.painted(self.stock["stone"]) for ring in rings)]

    def sink(self, row: Row) -> list[Part]:
        """A basin and a draining board."""
        x, y, z = row.size
        rim, split = 0.03, y * 0.1
        parts = [box(x, y * 0.4, 0.012).moved(0, -y * 0.3, z / 2 - 0.006)]
        parts += [box(x - 0.1, 0.006, 0.008).moved(0, -y * (0.14 + 0.07 * k), z / 2 + 0.001) for k in range(5)]
        parts += [box(x, rim, 0.012).moved(0, v, z / 2 - 0.006) for v in (y / 2 - rim / 2, -split + rim / 2)]
        length = y / 2 + split
        middle = (y / 2 - split) / 2
        parts += [box(rim, length, 0.012).moved(s * (x - rim) / 2, middle, z / 2 - 0.006) for s in (1, -1)]
        parts += [box(x - 2 * rim, length - 2 * rim, 0.01).moved(0, middle, -z / 2 + 0.005)]
        parts += [box(0.006, length - 2 * rim, z).moved(s * (x / 2 - rim), middle, 0) for s in (1, -1)]
        parts += [box(x - 2 * rim, 0.006, z).moved(0, middle + s * (length / 2 - rim), 0) for s in (1, -1)]
        return [part.painted(self.stock["steel"]) for part in parts]

    def tap(self) -> list[Part]:
        spout = tube([(0, 0, 0), (0, 0, 0.15), (0.06, 0, 0.185), (0.22, 0, 0.16), (0.25, 0, 0.12)], 0.014, 10)
        knob = cylinder(0.03, 0.05, 0.006, 16).moved(z=0.025)
        return [part.painted(self.stock["steel"]) for part in (spout, knob)]

    def keyboard(self, row: Row) -> list[Part]:
        """The keys face up; its front is at -X."""
        x, y, z = row.size
        parts = [box(x, y, z * 0.5, 0.004).painted(self.stock["black"])]
        for k in range(5):
            keys = box(x * 0.13, y * 0.94, z * 0.5).moved((k - 2) * x * 0.17, 0, z * 0.4)
            parts.append(keys.painted(self.stock["stone"]))
        return parts

    def monitor(self, row: Row) -> list[Part]:
        """It faces -Y."""
        x, _, z = row.size
        return [
            rounded_box(x, 0.03, z * 0.86, 0.01, 1).moved(0, 0, z * 0.07).painted(self.stock["black"]),
            box(x * 0.94, 0.004, z * 0.76).moved(0, -0.017, z * 0.08).painted(self.stock["sky"]),
            box(0.05, 0.05, z * 0.2).moved(0, 0.03, -z * 0.4).painted(self.stock["steel"]),
            box(x * 0.4, 0.16, 0.014).moved(0, 0.03, -z * 0.5).painted(self.stock["steel"]),
        ]

    def computer(self, row: Row) -> list[Part]:
        x, y, z = row.size
        return [
            rounded_box(x, y - 0.01, z, 0.012, 1).painted(self.stock["black"]),
            box(x * 0.8, 0.01, 0.03).moved(0, -y / 2 + 0.002, z * 0.32).painted(self.stock["steel"]),
            box(0.02, 0.01, 0.02).moved(0, -y / 2 + 0.002, z * 0.2).painted(self.stock["leaf"]),
        ]

    def compass(self) -> list[Part]:
        """Three arrows of 0.1 m: X red, Y green, Z blue."""
        shafts = [
            tube([(0, 0, 0), tuple(0.1 * (k == axis) for k in range(3))], 0.004, 8).painted(self.stock[paint])
            for axis, paint in enumerate(("red", "leaf", "sky"))
        ]
        return [cylinder(0.008, 0.016, columns=10).painted(self.stock["white"]), *shafts]


def _pictured(name: str, color: str, picture: object) -> object:
    return material(name, color, 0.85, image=packed(f"{name.lower()}.jpg", picture))


def _tiles() -> object:
    return speckle(512, "#c2c6c3", "#d3d6d2", 91) * (1 - 0.22 * lines(512, 6, 0.02)[..., None])
