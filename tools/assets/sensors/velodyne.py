"""A rotating laser scanner; the beams start at its centre."""

from __future__ import annotations

from common.colors import NAVY, STEEL, TEAL
from common.materials import material
from common.objects import exact
from common.shapes import box, cylinder, lathe


def build() -> None:
    steel, black = material("Steel", STEEL, 0.25, 0.9), material("Window", "#0d1218", 0.08)
    cap, ring = material("Cap", NAVY, 0.4), material("Ring", TEAL, 0.4)
    parts = [
        lathe([(0, -0.1), (0.092, -0.1), (0.1, -0.09), (0.1, -0.055), (0.09, -0.045), (0, -0.045)], 40).painted(steel),
        cylinder(0.094, 0.11, 0.003, 40).moved(z=0.008).painted(black),
        cylinder(0.097, 0.008, 0.001, 40).moved(z=-0.044).painted(ring),
        lathe([(0, 0.06), (0.1, 0.06), (0.1, 0.085), (0.088, 0.1), (0, 0.1)], 40).painted(cap),
        # one notch marks the front
        box(0.01, 0.03, 0.012, 0.002).moved(0.095, 0, -0.072).painted(ring),
    ]
    exact("VelodyneMesh", parts, (0.2, 0.2, 0.2), (0, 0, 0), physics_type="NO_COLLISION")
