"""A closed office for mapping: a reception, a corridor around a core, and eight rooms; the origin is in the reception.

Doors are 1.4 m wide and 2.1 m high; the walls, 2.7 m high, are boxes without a gap to the outside.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from common.images import packed
from common.materials import material
from common.objects import exact, hidden_box, lamp, solid, viewpoint
from common.office_rooms import furnish
from common.rooms import panes, trim, wall
from common.shapes import rectangle
from common.sky import sky
from common.textures import lines, planks, speckle

if TYPE_CHECKING:
    from common.rooms import Opening

#: centre of the building
AT = (10.5, 0.0, 0.0)
EAST, NORTH, HEIGHT, THICK = 13.0, 9.0, 2.7, 0.15
#: inner and outer walls of the corridor
CORE, RING = (6.0, 2.2), (8.0, 4.2)
DOOR, SILL, LINTEL = 1.4, 0.9, 2.1

Line = tuple[tuple[float, float], tuple[float, float], tuple["Opening", ...]]


def along_x(y: float, x0: float, x1: float, doors: tuple[float, ...] = (), windows: tuple[float, ...] = ()) -> Line:
    """A wall from x0 to x1, with the middles of its doors and windows."""
    return ((x0, y), (x1, y), openings(x0, doors, windows))


def along_y(x: float, y0: float, y1: float, doors: tuple[float, ...] = (), windows: tuple[float, ...] = ()) -> Line:
    """A wall from y0 to y1, with the middles of its doors and windows."""
    return ((x, y0), (x, y1), openings(y0, doors, windows))


def openings(start: float, doors: tuple[float, ...], windows: tuple[float, ...]) -> tuple[Opening, ...]:
    through = [(at - start - DOOR / 2, at - start + DOOR / 2, 0.0, LINTEL) for at in doors]
    return (*through, *((at - start - 0.9, at - start + 0.9, SILL, LINTEL) for at in windows))


#: the end of a wall that joins another one
INSIDE = (EAST - THICK, NORTH - THICK)
OUTER: tuple[Line, ...] = (
    along_x(-NORTH, -EAST, EAST, windows=(-10.5, -6.2, -3.4, -0.6, 2.2, 6.2, 9.0, 11.4)),
    along_x(NORTH, -EAST, EAST, windows=(-10.5, -5.2, 0.0, 4.2, 7.0, 9.8)),
    along_y(-EAST, -INSIDE[1], INSIDE[1], windows=(-6.5, -2.7, 2.7, 6.5)),
    along_y(EAST, -INSIDE[1], INSIDE[1], windows=(-6.5, -1.6, 1.6, 6.5)),
)
INNER: tuple[Line, ...] = (
    along_x(RING[1], -INSIDE[0], INSIDE[0], doors=(-10.5, -5.2, 0.0, 5.2, 10.5)),
    along_x(-RING[1], -INSIDE[0], INSIDE[0], doors=(-10.5, -6.0, 2.0, 6.0, 10.5)),
    ((-RING[0], THICK - RING[1]), (-RING[0], RING[1] - THICK), ((3.15, 4.95, 0.0, 2.3),)),
    along_y(RING[0], THICK - RING[1], RING[1] - THICK, doors=(0.0,)),
    *(along_y(x, RING[1] + THICK, INSIDE[1]) for x in (-RING[0], -2.6, 2.6)),
    *(along_y(x, -INSIDE[1], -RING[1] - THICK) for x in (-RING[0], 4.0)),
)
MIDDLE: tuple[Line, ...] = (
    along_x(CORE[1], -CORE[0], CORE[0], doors=(-1.0,), windows=(-4.5, -2.6)),
    along_x(-CORE[1], -CORE[0], CORE[0], doors=(3.0,), windows=(-4.5, -2.4)),
    *(along_y(x, THICK - CORE[1], CORE[1] - THICK) for x in (-CORE[0], 0.0, CORE[0])),
)
#: west, south, east and north end of the floors
FLOORS = {
    "Stone": ((-EAST, -RING[1], -RING[0], RING[1]), (-EAST, -NORTH, -RING[0], -RING[1])),
    "Carpet": (
        (-RING[0], -NORTH, 4.0, -RING[1]),
        (RING[0], -RING[1], EAST, RING[1]),
        (2.6, RING[1], EAST, NORTH),
        (-CORE[0], -CORE[1], 0.0, CORE[1]),
    ),
    "Moss": ((4.0, -NORTH, EAST, -RING[1]), (-EAST, RING[1], 2.6, NORTH), (0.0, -CORE[1], CORE[0], CORE[1])),
    "Boards": (
        (-RING[0], CORE[1], RING[0], RING[1]),
        (-RING[0], -RING[1], RING[0], -CORE[1]),
        (-RING[0], -CORE[1], -CORE[0], CORE[1]),
        (CORE[0], -CORE[1], RING[0], CORE[1]),
    ),
}
STILL = {"physics_type": "STATIC"}
SHOWN = {"physics_type": "NO_COLLISION"}


def build() -> None:
    sky("#cfdde6")
    light()
    ground()
    floors()
    walls()
    ceiling()
    furnish(AT)
    viewpoint((-5.5, -20.5, 20.5), (9.9, -0.9, 0.0), 25.0)


def light() -> None:
    lamp("Sun", "SUN", 2.4, (0, -10, 16), (0.5, 0.28, 0.2), color="#fff4e2")
    places = ((-10.5, 0.0), (-4.0, -6.5), (-4.0, 6.5), (0.0, 0.0), (8.5, 6.5), (9.0, -6.5), (10.5, 0.0))
    for number, (x, y) in enumerate(places, start=1):
        lamp(f"Lamp{number}", "POINT", 130.0, (x + AT[0], y, 2.4), color="#fff0d6", shadow=False)


def ground() -> None:
    """The ground around the building: a lawn with a paved edge."""
    grass = material("Lawn", "#7fa65c", 0.95, image=packed("lawn.jpg", speckle(256, "#6f9a4e", "#90b56a", 71)))
    slabs = speckle(256, "#b5b1a8", "#c6c2ba", 73) * (1 - 0.2 * lines(256, 2, 0.03)[..., None])
    paving = material("Paving", "#bdb9b1", 0.9, image=packed("paving.jpg", slabs))
    lawn = [rectangle(160, 160).mapped(6.0).painted(grass)]
    exact("Ground", lawn, (160, 160, 0), (0, 0, 0), (AT[0], AT[1], -0.03), **STILL)
    edge = rectangle(2 * EAST + 4.0, 2 * NORTH + 4.0).mapped(2.0).painted(paving)
    solid("Paving", [edge], (AT[0], AT[1], -0.015), **SHOWN)


def floors() -> None:
    stone = speckle(256, "#cfc8bb", "#ded8cc", 75) * (1 - 0.14 * lines(256, 2, 0.02)[..., None])
    carpet = speckle(256, "#5d7480", "#72899a", 77, fine=90.0) * (1 - 0.08 * lines(256, 2, 0.02)[..., None])
    moss = speckle(256, "#6f7f66", "#87977a", 78, fine=90.0) * (1 - 0.08 * lines(256, 2, 0.02)[..., None])
    paints = {
        "Stone": material("Stone Floor", "#d6d0c4", 0.6, image=packed("stone.jpg", stone)),
        "Carpet": material("Carpet", "#687f8d", 0.95, image=packed("carpet.jpg", carpet)),
        "Moss": material("Moss Carpet", "#7b8b70", 0.95, image=packed("moss.jpg", moss)),
        "Boards": material(
            "Boards", "#c79a6a", 0.5, image=packed("boards.jpg", planks(512, "#b98a58", "#d6ab79", 8, 81))
        ),
    }
    parts = [
        rectangle(x1 - x0, y1 - y0).moved((x0 + x1) / 2, (y0 + y1) / 2).mapped(2.0).painted(paints[name])
        for name, places in FLOORS.items()
        for x0, y0, x1, y1 in places
    ]
    solid("Floor", parts, AT, **SHOWN)
    # one level box, so that wheels do not cross seams between floors
    size = (2 * EAST + THICK, 2 * NORTH + THICK, 0.2)
    hidden_box("Floor_bb", size, (AT[0], AT[1], -0.1), **STILL)


def walls() -> None:
    plaster = packed("plaster.jpg", speckle(256, "#ece6d9", "#f5f1e8", 83))
    paints = {
        "OuterWalls": material("Outer Wall", "#f1ece1", 0.9, image=plaster),
        "InnerWalls": material("Inner Wall", "#f4efe6", 0.9, image=plaster),
        "CoreWalls": material("Core Wall", "#4f8f94", 0.85),
    }
    skirting, frames, sheets = [], [], []
    for (name, paint), lines_ in zip(paints.items(), (OUTER, INNER, MIDDLE), strict=True):
        pieces = [part for line in lines_ for part in wall(*line, THICK, HEIGHT)]
        solid(name, [part.mapped(2.0).painted(paint) for part in pieces], AT, **STILL)
        for start, end, holes in lines_:
            boards, around = trim(start, end, holes, THICK)
            skirting += boards
            frames += around
            sheets += panes(start, end, holes, 0.03)
    white, oak = material("Skirting", "#fbf9f3", 0.6), material("Frame", "#9c7146", 0.6)
    solid("Trim", [*(p.painted(white) for p in skirting), *(p.painted(oak) for p in frames)], AT, **SHOWN)
    glass = material("Glass", "#a9ccd9", 0.1)
    solid("Panes", [part.painted(glass) for part in sheets], AT, **STILL)


def ceiling() -> None:
    """A roof that is visible only from inside: from above, the view shows the rooms."""
    tiles = speckle(256, "#f1efe9", "#faf9f5", 87) * (1 - 0.1 * lines(256, 4, 0.02)[..., None])
    paint = material("Ceiling", "#f6f4ef", 0.95, image=packed("ceiling.jpg", tiles), glow=0.3, one_sided=True)
    glow = material("Lamp", "#fff6e0", 0.5, glow=1.2, one_sided=True)
    cover = [rectangle(2 * EAST - THICK, 2 * NORTH - THICK).turned(x=180).mapped(2.4).painted(paint)]
    solid("Ceiling", cover, (AT[0], AT[1], HEIGHT), **STILL)
    panels = [
        rectangle(1.2, 0.3).turned(x=180).moved(x, y).painted(glow)
        for y in (-6.6, -3.2, 0.0, 3.2, 6.6)
        for x in np.linspace(-11.0, 11.0, 9)
    ]
    solid("CeilingLamps", panels, (AT[0], AT[1], HEIGHT - 0.01), **SHOWN)
