"""A laser scanner that faces +X; the beam starts at the centre of its cube."""

from __future__ import annotations

from common.colors import NAVY, STEEL
from common.materials import material
from common.objects import exact
from common.shapes import box, cylinder, lathe, rounded_box


def build() -> None:
    blue, black, steel = (
        material("Shell", "#2f62c4", 0.4),
        material("Window", "#10151b", 0.1),
        material("Steel", STEEL, 0.35, 0.9),
    )
    parts = [
        rounded_box(0.17, 0.2, 0.085, 0.02, 2).moved(-0.012, 0, -0.0575).painted(blue),
        rounded_box(0.19, 0.19, 0.05, 0.02, 2).moved(0.0, 0, 0.075).painted(blue),
        lathe([(0, -0.02), (0.085, -0.02), (0.092, 0.055), (0, 0.055)], 36).painted(black),
        box(0.07, 0.19, 0.08, 0.008).moved(-0.063, 0, 0.02).painted(blue),
        box(0.012, 0.1, 0.022, 0.003).moved(0.072, 0, -0.06).painted(material("Plate", NAVY, 0.5)),
    ]
    for number, (color, y) in enumerate((("#3ddc5a", 0.03), ("#f5b83d", 0.0), ("#e1382c", -0.03))):
        parts.append(
            cylinder(0.006, 0.006, 0.001, 12)
            .turned(y=90)
            .moved(0.079, y, -0.06)
            .painted(material(f"Light {number}", color, 0.3, glow=0.8))
        )
    parts.append(cylinder(0.012, 0.02, 0.003, 12).turned(y=90).moved(-0.1, 0.05, -0.05).painted(steel))
    exact("SickMesh", parts, (0.2, 0.2, 0.2), (0, 0, 0), physics_type="NO_COLLISION")
