"""Grassland with trees, a small town, and six detached houses of up to six storeys."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import bpy
from common.land import ground, grove, town, town_ground
from common.objects import empty, solid, twin, viewpoint
from common.shapes import box, prism
from common.sky import sky, sunshine
from common.town import Masonry, wall_box

if TYPE_CHECKING:
    from common.objects import Triple
    from common.parts import Part

#: position of the tree, of the shapes of its trunk and of its crown, of the visible mesh; angle about Z
TREES = (
    ((2.83, -1.34, 0), (2.81, -1.29, 1.04), (2.73, -1.27, 3.26), (2.83, -1.32, 0.015), 0),
    ((6.18, -4.76, 0), (6.2, -4.72, 1.04), (6.17, -4.64, 3.26), (6.19, -4.75, 0.015), -0.875),
    ((8.11, -0.67, 0), (8.09, -0.623, 1.04), (8.01, -0.599, 3.26), (8.11, -0.651, 0.015), 0.02),
    ((5.43, 3.12, 0), (5.43, 3.18, 1.04), (5.36, 3.23, 3.26), (5.44, 3.14, 0.015), -0.336),
    ((-5.44, -1.32, 0), (-5.44, -1.27, 1.04), (-5.5, -1.22, 3.26), (-5.43, -1.31, 0.015), -0.336),
    ((-10.2, -1.58, 0), (-10.3, -1.54, 1.04), (-10.3, -1.54, 3.26), (-10.2, -1.56, 0.015), 0.319),
    ((12.6, -6.46, 1.08), (12.6, -6.42, 1.18), (12.5, -6.42, 3.4), (12.6, -6.44, 0.152), 0.319),
    ((20.4, -9.8, 1.08), (20.4, -9.76, 1.12), (20.3, -9.76, 3.34), (20.4, -9.78, 0.091), 0.319),
    ((2.48, 1.57, 0), (2.47, 1.62, 1.04), (2.39, 1.64, 3.26), (2.48, 1.59, 0.015), 0),
    ((9.76, -3.65, 0), (9.77, -3.6, 1.04), (9.71, -3.54, 3.26), (9.77, -3.63, 0.015), -0.485),
    ((-29.5, 4.91, 0), (-29.5, 4.96, 1.04), (-29.6, 5.02, 3.26), (-29.5, 4.93, 0.015), -0.485),
    ((22.2, -13, 0), (22.2, -12.9, 1.04), (22.1, -12.9, 3.26), (22.2, -13, 0.015), -0.485),
    ((17.9, -12.4, 0), (17.9, -12.3, 1.04), (17.8, -12.3, 3.26), (17.9, -12.4, 0.015), 0.36),
    ((26.3, -3.27, 0), (26.3, -3.23, 1.04), (26.2, -3.23, 3.26), (26.3, -3.25, 0.015), 0.36),
    ((28.2, -33.3, 0), (28.1, -33.3, 1.04), (28.1, -33.3, 3.26), (28.2, -33.3, 0.015), 0.36),
)  # fmt: skip
TOWN = (18.3, 41.8, 5.23)
#: m: distance between two floors, and overhang of the roof
STOREY, ROOF = 2.2, (2.36, 0.907, 1.6)
#: centre of a floor, and its size
MIDDLE, SIZE = (3.67, 0.0), (10.7, 9.82)
#: name of the house, its position, angle about Z, suffix of the names of its parts, heights of the floors, the roof
HOUSES = (
    ("buildingA", (32.9, -54.9, -0.092), 1.61, ".0010", (2.31, 4.51, 6.71, 8.91), (31.9, -52.6, 12.7)),
    ("buildingB", (45.9, -48.7, -0.616), 0.044, "", (1.78, 3.98, 6.18, 8.38), (48.3, -47.7, 12.2)),
    ("buildingC", (-38.6, -3.91, -0.191), 1.61, ".001", (2.21, 4.41, 6.61, 8.81), (-39.6, -1.54, 12.6)),
    ("buildingD", (-24.5, -2.31, -0.23), 0.375, ".0011", (2.17,), (-22.6, -0.592, 5.96)),
    ("buildingE", (33.1, -67.6, -0.416), 0.375, ".002", (1.98,), (35, -65.9, 5.77)),
    ("buildingF", (45.9, -30.7, -0.083), -1.87, ".003", (2.32,), (46.1, -33.2, 6.1)),
)
#: by the number of upper floors: names of the floors and of the roof, without suffix
NAMES = {4: (("building1", "building2", "building3", "building5"), "building4"), 1: (("building2",), "building1")}


def build() -> None:
    sky("#a9cfe8")
    sunshine(3.2, (0.7, 0.3, 0.6))
    rooted = [(*seen[:2], seen[2]) for *_, seen, _ in TREES]
    below = [place for _, at, turn, *_ in HOUSES for place in foot(at, turn)]
    land = ground([*rooted, *below, *town_ground(TOWN, 0.56, [*rooted, *below])], dip=-0.045, rise=2.785, seed=4)
    town(land, TOWN, (42.1, 67.9, 11.5), (0, 0, 1.08), rooted)
    houses()
    grove(TREES)
    viewpoint((16.0, 13.0, 7.0), (-2.0, -4.0, 1.0))


def foot(at: tuple[float, float, float], turn: float) -> list[tuple[float, float, float]]:
    """The areas below a house where the ground has to be flat."""
    grid = [(MIDDLE[0] + x, MIDDLE[1] + y) for x in (-8, 0, 8) for y in (-8, 0, 8)]
    c, s = math.cos(turn), math.sin(turn)
    return [(at[0] + c * x - s * y, at[1] + s * x + c * y, 0.0) for x, y in grid]


def houses() -> None:
    """Ground floors, upper floors and roofs; each kind shares one mesh."""
    masonry = Masonry.make()
    plaster, stone = masonry.facades[3], masonry.chimney
    first = [
        wall_box(*SIZE, STOREY).painted(plaster),
        box(SIZE[0] + 0.02, SIZE[1] + 0.02, 0.5).moved(z=0.2).painted(stone),
        box(1.3, 0.06, 2.0, 0.02).moved(0, -SIZE[1] / 2 - 0.01, 1.25).painted(masonry.roof),
    ]
    upper = [wall_box(*SIZE, STOREY).painted(plaster), box(SIZE[0] + 0.1, SIZE[1] + 0.1, 0.12).painted(stone)]
    top = [part.moved(-ROOF[0], -ROOF[1], -ROOF[2]) for part in roof(masonry)]
    floors = Floors({"firstfloor1010": first, "floor1010": upper, "roof1010": top})
    for name, at, turn, suffix, heights, cap_at in HOUSES:
        house = floors.put("firstfloor1010", name, at, turn, bpy.data.objects["Buildings"])
        storeys, cap = NAMES[len(heights)]
        for storey, height in zip(storeys, heights, strict=True):
            floors.put("floor1010", storey + suffix, (*at[:2], height), turn, house)
        floors.put("roof1010", cap + suffix, cap_at, turn, house)


def roof(masonry: Masonry) -> list[Part]:
    """A gable roof on z=0 with two chimneys."""
    x, y = SIZE[0] / 2 + 0.45, SIZE[1] / 2 + 0.35
    gable = prism([(-x, 0.0), (x, 0.0), (x, 0.12), (0.0, 3.0), (-x, 0.12)], 2 * y).turned(x=90).moved(0, y, 0)
    pots = [box(0.7, 0.7, 1.3).moved(-2.2, v, 2.2).painted(masonry.chimney) for v in (-2.5, 2.5)]
    return [gable.painted(masonry.roof), *pots]


class Floors:
    """Storeys that are stacked on one another."""

    def __init__(self, kinds: dict[str, list[Part]]) -> None:
        self._kinds = {kind: [part.moved(*MIDDLE) for part in parts] for kind, parts in kinds.items()}
        self._first: dict[str, bpy.types.Object] = {}
        self._count: dict[str, int] = {}

    def put(self, kind: str, name: str, at: Triple, turn: float, parent: bpy.types.Object) -> bpy.types.Object:
        """An empty with that name, and the mesh of a storey as its child."""
        root = empty(name, at, (0, 0, turn), parent=parent, physics_type="STATIC")
        number = self._count[kind] = self._count.get(kind, -1) + 1
        mesh = f"{kind}.{number:03}" if number else kind
        options = {"parent": root, "physics_type": "STATIC", "collision": "mesh"}
        if kind in self._first:
            twin(self._first[kind], mesh, at, (0, 0, turn), **options)
        else:
            self._first[kind] = solid(mesh, self._kinds[kind], at, (0, 0, turn), **options)
        return root
