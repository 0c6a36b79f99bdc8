"""A hall with three coloured boxes, for testing sensors."""

from __future__ import annotations

from common.colors import RUBBER
from common.hall import coloured_box, hall
from common.materials import material
from common.objects import exact, viewpoint
from common.shapes import cylinder
from common.sky import sky

SIZE = (1.0, 1.0, 1.8)
#: height of the rubber feet: scripts of 1.4 expect the top of a box at rest at 1.86 m
FOOT = 0.06
BOXES = (
    ("RedBox", "#d3191c", "#9c0f12", (-7.5, 0.0, 0.99)),
    ("BlueBox", "#1a45d6", "#10309b", (-3.5, -3.0, 0.97)),
    ("GreenBox", "#00f200", "#00b400", (-6.5, 6.0, 1.0)),
)


def build() -> None:
    sky("#cfd8df")
    hall()
    rubber = material("Rubber", RUBBER, 0.9)
    for name, color, dark, at in BOXES:
        parts = coloured_box(material(name, color, 0.45), material(f"{name} Edge", dark, 0.5), SIZE)
        root = exact(
            name, parts, SIZE, (0, 0, 0), at, physics_type="RIGID_BODY", collision="box", mass=1.0, Object=name
        )
        corners = [(x * 0.42, y * 0.42) for x in (-1, 1) for y in (-1, 1)]
        feet = [cylinder(0.05, FOOT, 0.004, 20).moved(x, y).painted(rubber) for x, y in corners]
        under = (at[0], at[1], at[2] - (SIZE[2] + FOOT) / 2)
        exact(
            f"{name}_feet",
            feet,
            (0.94, 0.94, FOOT),
            (0, 0, 0),
            under,
            parent=root,
            physics_type="RIGID_BODY",
            collision="box",
            mass=0.1,
        )
    viewpoint((5.5, -8.5, 4.6), (-3.4, 1.2, 0.6))
