"""A gripper with two fingers that close along Y; it reaches along +Z."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from common.colors import NAVY, RUBBER, STEEL, TEAL
from common.materials import material
from common.objects import exact
from common.shapes import cylinder, lathe, prism, rounded_box

if TYPE_CHECKING:
    from common.parts import Part

BACK = (0.0, 0.0, -math.pi)


def build() -> None:
    teal, black, steel = material("Shell", TEAL, 0.4), material("Black", NAVY, 0.45), material("Steel", STEEL, 0.3, 0.9)
    rubber = material("Rubber", RUBBER, 0.9)
    palm = [
        cylinder(0.03, 0.02, 0.003, 32).moved(z=-0.027).painted(steel),
        rounded_box(0.06, 0.074, 0.044, 0.01, 2).moved(z=0.0).painted(teal),
        rounded_box(0.05, 0.07, 0.020, 0.006, 2).moved(z=0.026).painted(black),
        # the camera in the palm sees the object between the fingers
        lathe([(0, 0.03), (0.016, 0.03), (0.013, 0.045), (0.011, 0.062), (0, 0.062)], 24).painted(steel),
        lathe([(0, 0.062), (0.011, 0.062), (0.011, 0.069), (0.008, 0.074), (0, 0.075)], 24).painted(black),
    ]
    root = exact(
        "Gripper", palm, (0.06, 0.074, 0.112), (0, 0, 0.019), (0, 0, 0.037), physics_type="STATIC", collision="box"
    )
    show = {"parent": root, "physics_type": "NO_COLLISION"}
    one = exact("finger1", finger(0.022, steel), (0.022, 0.039, 0.075), (0, -0.016, 0.086), (0, 0, 0), BACK, **show)
    two = exact(
        "finger2", [p for x in (-0.02, 0.02) for p in claw(x, steel)], (0.056, 0.039, 0.075), (0, -0.016, 0.086), **show
    )
    for name, parent, at, turned in (
        ("pad1", one, (0, 0.023, 0.115), (0, 0, 0)),
        ("pad2", two, (-0.02, -0.023, 0.115), (0, 0, math.pi)),
        ("pad3", two, (0.02, -0.023, 0.115), (0, 0, math.pi)),
    ):
        pad = rounded_box(0.01, 0.005, 0.01, 0.002, 1).painted(rubber)
        exact(name, [pad], (0.01, 0.005, 0.01), (0, -0.001, 0), at, turned, parent=parent, physics_type="NO_COLLISION")


#: a bent finger on the -Y side, (y, z)
OUTLINE = (
    (0.0, 0.050), (-0.016, 0.050), (-0.035, 0.078), (-0.0355, 0.112), (-0.030, 0.1235), (-0.0255, 0.1235),
    (-0.024, 0.116), (-0.024, 0.084), (-0.004, 0.062),
)  # fmt: skip


def finger(width: float, metal) -> list[Part]:
    turned = [(z, y) for y, z in OUTLINE]  # the prism's X and Y become Z and Y
    bar = prism(turned, width * 0.86).moved(z=-width * 0.43).turned(y=-90)
    return [bar.painted(metal), cylinder(0.0065, width, 0.001, 20).turned(y=90).moved(0, -0.003, 0.056).painted(metal)]


def claw(x: float, metal) -> list[Part]:
    return [part.moved(x=x) for part in finger(0.016, metal)]
