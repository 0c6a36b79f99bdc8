"""A pan-tilt unit."""

from __future__ import annotations

from common.colors import NAVY, STEEL, TEAL
from common.materials import material
from common.objects import empty, exact
from common.shapes import cylinder, rounded_box


def build() -> None:
    black, steel, teal = material("Black", NAVY, 0.45), material("Steel", STEEL, 0.3, 0.9), material("Teal", TEAL, 0.4)
    root = empty("PTU", physics_type="NO_COLLISION")
    pan = [
        rounded_box(0.06, 0.04, 0.024, 0.005, 2).moved(z=0.002).painted(black),
        cylinder(0.019, 0.006, 0.001, 28).moved(z=-0.013).painted(steel),
        cylinder(0.016, 0.005, 0.001, 28).moved(0.01, 0, 0.0125).painted(teal),
    ]
    base = exact("PanBase", pan, (0.06, 0.04, 0.03), (0, 0, 0), (0, 0, 0.015), parent=root, physics_type="NO_COLLISION")
    tilt = [
        cylinder(0.012, 0.06, 0.002, 28).turned(x=90).moved(z=-0.012).painted(steel),
        rounded_box(0.034, 0.05, 0.022, 0.006, 2).moved(z=-0.012).painted(teal),
        rounded_box(0.04, 0.04, 0.006, 0.002, 1).moved(z=0.002).painted(black),
    ]
    exact(
        "TiltBase", tilt, (0.04, 0.06, 0.03), (0, 0, -0.01), (0.01, 0, 0.035), parent=base, physics_type="NO_COLLISION"
    )
