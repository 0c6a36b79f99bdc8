"""An upright arm of seven joints in a row: they turn alternately about the arm and about its Y axis."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from common.armatures import Joint, armature, hang
from common.colors import CORAL, NAVY, STEEL, WHITE
from common.materials import material
from common.objects import exact
from common.shapes import cylinder, lathe, rounded_box, torus

if TYPE_CHECKING:
    from common.parts import Part

_ALONG, _ACROSS = math.radians(170.0), math.radians(120.0)
#: ends of the bones, metres above the foot, where the first bone begins
_ENDS = (0.0, 0.3105, 0.5105, 0.7105, 0.9105, 1.1005, 1.1785, 1.3105)
_RADIUS = 0.06


def build() -> None:
    coral, white, black, steel = (
        material("Shell", CORAL, 0.35),
        material("Cover", WHITE, 0.35),
        material("Black", NAVY, 0.45),
        material("Steel", STEEL, 0.3, 0.9),
    )

    def link(reach: float, side: float) -> list[Part]:
        """A tube from the joint to ``reach`` above or below it, and the hub of the joint on one side of the arm."""
        way = math.copysign(1.0, reach)
        tube = [(0, reach), (0.052, reach), (_RADIUS, reach - way * 0.012), (_RADIUS, way * 0.06), (0.04, 0.0), (0, 0)]
        return [
            lathe(tube if way < 0 else tube[::-1], 40).painted(coral),
            torus(0.057, 0.005, 40, 8).moved(z=reach - way * 0.03).painted(black),
            cylinder(_RADIUS, 0.07, 0.012, 40).turned(x=90).moved(0, side * 0.053, 0).painted(coral),
            rounded_box(0.1, 0.08, 0.1, 0.03, 3).moved(0, side * 0.025, way * 0.05).painted(coral),
            cylinder(0.044, 0.01, 0.003, 36).turned(x=90).moved(0, side * 0.089, 0).painted(white),
            cylinder(0.014, 0.012, 0.002, 24).turned(x=90).moved(0, side * 0.0895, 0).painted(steel),
        ]

    foot = [
        lathe([(0, 0), (0.073, 0), (0.073, 0.014), (0.066, 0.02), (0.062, 0.11), (0.055, 0.1195), (0, 0.1195)], 40)
        .moved(z=-0.3105)
        .painted(white),
        rounded_box(0.05, 0.07, 0.05, 0.012, 2).moved(0.065, 0, -0.27).painted(black),
        *(
            cylinder(0.006, 0.008, 0.0015, 10).moved(0.067, 0, -0.292).turned(z=angle).painted(steel)
            for angle in range(45, 360, 90)
        ),
    ]
    wrist = [
        cylinder(0.056, 0.1, 0.02, 40).turned(x=90).moved(0, 0, 0).turned(z=90).painted(coral),
        rounded_box(0.12, 0.1, 0.1, 0.04, 3).moved(0.02, 0, 0.0).painted(coral),
        cylinder(0.05, 0.02, 0.004, 36).moved(z=0.048).painted(black),
        cylinder(0.04, 0.012, 0.003, 36).turned(y=90).moved(0.075, 0, 0).painted(white),
    ]
    flange = [
        cylinder(0.04, 0.02, 0.004, 36).moved(z=0.058).painted(steel),
        cylinder(0.03, 0.031, 0.002, 30).moved(z=0.062).painted(black),
    ]
    bones = [
        Joint(
            f"kuka_{i + 1}",
            (0, 0, _ENDS[i]),
            (0, 0, _ENDS[i + 1]),
            (0, -1, 0) if i in (1, 2, 5) else (0, 1, 0),
            "y" if i % 2 == 0 else "z",
            _ALONG if i % 2 == 0 else _ACROSS,
        )
        for i in range(7)
    ]
    arm = armature("kuka_armature", bones, physics_type="STATIC")
    back = (0.0, 0.0, math.pi)
    for name, parts, z, turned, size, centre in (
        ("kuka_1", link(-0.208, -1), 0.3105, back, (0.121, 0.154, 0.269), (0, -0.017, -0.074)),
        ("kuka_2", link(0.2085, 1), 0.3105, back, (0.121, 0.155, 0.269), (0, 0.019, 0.074)),
        ("kuka_3", link(-0.2085, 1), 0.7105, back, (0.122, 0.154, 0.268), (0, 0.019, -0.074)),
        ("kuka_4", link(0.2085, 1), 0.7105, (0, 0, 0), (0.121, 0.154, 0.269), (0, 0.017, 0.074)),
        ("kuka_5", link(-0.1985, 1), 1.1005, (0, 0, 0), (0.121, 0.154, 0.259), (0, 0.017, -0.069)),
        ("kuka_6", wrist, 1.1005, (0, 0, -math.pi / 2), (0.135, 0.143, 0.128), (0.011, 0, -0.007)),
        ("kuka_7", flange, 1.1005, (0, 0, 0), (0.081, 0.08, 0.031), (0, 0.001, 0.062)),
    ):
        tags = {"end_effector": 1} if name == "kuka_7" else {}
        part = exact(
            name, parts, size, centre, (0, 0, z), turned, physics_type="STATIC", collision="box", internal=1, **tags
        )
        hang(part, arm, name)
    exact(
        "kuka_base",
        foot,
        (0.163, 0.146, 0.12),
        (0.009, 0, -0.251),
        (0, 0, 0.3105),
        parent=arm,
        physics_type="STATIC",
        collision="box",
        internal=1,
    )
