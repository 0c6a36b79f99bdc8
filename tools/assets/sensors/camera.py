"""A small camera that looks along its -Z axis, as in Blender; the origin is the optical centre."""

from __future__ import annotations

from common.colors import CREAM, NAVY, STEEL
from common.materials import material
from common.objects import exact
from common.shapes import cylinder, lathe, rounded_box, torus


def build() -> None:
    cream, black, steel = (
        material("Shell", CREAM, 0.4),
        material("Black", NAVY, 0.4),
        material("Steel", STEEL, 0.3, 0.9),
    )
    glass = material("Glass", "#16303c", 0.05)
    parts = [
        rounded_box(0.05, 0.05, 0.05, 0.01, 2).moved(z=-0.026).painted(cream),
        lathe([(0, -0.085), (0.019, -0.085), (0.021, -0.08), (0.021, -0.05), (0, -0.05)], 28).painted(black),
        torus(0.0205, 0.0018, 28, 6).moved(z=-0.064).painted(steel),
        lathe([(0, -0.0865), (0.008, -0.0862), (0.0135, -0.085), (0, -0.0845)], 24).painted(glass),
        cylinder(0.003, 0.003, 0.0005, 10)
        .moved(0.017, 0.017, -0.051)
        .painted(material("Light", "#e1382c", 0.3, glow=1.0)),
    ]
    exact("CameraMesh", parts, (0.05, 0.05, 0.085), (0, 0, -0.042), physics_type="NO_COLLISION")
