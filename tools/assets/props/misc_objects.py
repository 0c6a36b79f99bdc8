"""Books in three colours and sizes, and a bottle."""

from __future__ import annotations

from typing import TYPE_CHECKING

from common.household import bottle
from common.materials import material
from common.objects import exact
from common.shapes import box, rounded_box
from common.stock import Stock

if TYPE_CHECKING:
    from common.parts import Part

#: name, position, size and centre of the bounding box
BOOKS = (
    ("Book_Blue_fat", (0.254, 0.399, 0.1), (0.084, 0.135, 0.2), (0, 0.01, 0)),
    ("Book_Blue_medium", (0.364, 0.399, 0.09), (0.05, 0.135, 0.18), (0, 0.01, 0)),
    ("Book_Blue_thin", (0.499, 0.399, 0.1), (0.02, 0.135, 0.2), (0, 0.01, 0)),
    ("Book_Brown_fat", (0.254, 0.648, 0.1), (0.084, 0.135, 0.2), (0, 0.01, 0)),
    ("Book_Brown_medium", (0.364, 0.648, 0.095), (0.05, 0.135, 0.19), (0, 0.01, 0)),
    ("Book_Brown_thin", (0.499, 0.648, 0.11), (0.02, 0.135, 0.22), (0, 0.01, 0)),
    ("Book_Wine_fat", (0.254, 0.196, 0.084), (0.084, 0.119, 0.167), (0, 0.009, 0)),
    ("Book_Wine_medium", (0.364, 0.193, 0.1), (0.05, 0.148, 0.2), (0, 0.011, 0)),
    ("Book_Wine_thin", (0.499, 0.198, 0.076), (0.02, 0.095, 0.151), (0, 0.007, 0)),
)  # fmt: skip
COLORS = {"Blue": "#27509c", "Brown": "#7b4a2a", "Wine": "#7d1f35"}


def build() -> None:
    stock = Stock()
    covers = {name: material(f"Cover {name}", color, 0.6) for name, color in COLORS.items()}
    gold = material("Gold", "#d9b45b", 0.4, 0.6)
    for name, at, size, centre in BOOKS:
        parts = book(*size, covers[name.split("_")[1]], stock["paper"], gold)
        exact(name, parts, size, centre, at, physics_type="RIGID_BODY", collision="box", mass=1.0)
    parts = [p.moved(z=-0.233) for p in bottle(stock, 0.2, 0.466)]
    exact(
        "Bottle",
        parts,
        (0.201, 0.201, 0.466),
        (0, 0, 0),
        (0, 0, 0.233),
        physics_type="RIGID_BODY",
        collision="cylinder",
        mass=1.12,
    )


def book(thick: float, deep: float, high: float, cover, paper, gold) -> list[Part]:
    """A standing book, its back towards -Y."""
    lid = min(0.004, thick * 0.15)
    parts = [box(lid, deep, high, lid * 0.3).moved(s * (thick - lid) / 2, 0, 0).painted(cover) for s in (1, -1)]
    parts.append(rounded_box(thick, lid * 2, high, lid * 0.9, 1).moved(0, -deep / 2 + lid, 0).painted(cover))
    parts.append(box(thick - 2 * lid, deep * 0.96, high * 0.96).moved(0, 0, 0).painted(paper))
    parts += [
        box(thick * 0.9, lid * 0.4, high * 0.02).moved(0, -deep / 2, z * high).painted(gold) for z in (-0.38, 0.3, 0.38)
    ]
    return parts
