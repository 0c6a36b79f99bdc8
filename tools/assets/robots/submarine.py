"""An autonomous submarine; its bow points along +X."""

from __future__ import annotations

import numpy as np
from common.colors import CORAL, NAVY, STEEL, SUN
from common.materials import material
from common.objects import exact
from common.parts import Part, mirrored
from common.rotors import blade
from common.shapes import cylinder, ellipsoid, lathe, prism, rounded_box, sphere, torus, tube


def build() -> None:
    exact("SubmarineMesh", vessel(), (6.05, 1.2, 1.31), (0, 0, -0.071), physics_type="STATIC", collision="box")


def vessel() -> list[Part]:
    """The hull lies along X, its axis at z=-0.2."""
    yellow, coral, black = material("Shell", SUN, 0.3), material("Coral", CORAL, 0.4), material("Black", NAVY, 0.5)
    steel, glass = material("Steel", STEEL, 0.3, 0.9), material("Glass", "#12303c", 0.05)
    light = material("Headlight", "#fff3cf", 0.2, glow=1.2)
    profile = [
        (0.0, -2.85),
        (0.10, -2.82),
        (0.2, -2.5),
        (0.36, -1.8),
        (0.47, -1.0),
        (0.5, 0.0),
        (0.5, 1.6),
        (0.48, 2.1),
        (0.42, 2.5),
        (0.33, 2.75),
    ]
    hull = lathe([*profile, (0.2, 2.93), (0.0, 3.0)], 40).turned(y=90)
    parts = [
        hull.painted(yellow),
        torus(0.505, 0.025, 40, 8).turned(y=90).moved(x=1.55).painted(coral),
        torus(0.485, 0.025, 40, 8).turned(y=90).moved(x=-0.85).painted(coral),
        ellipsoid(0.3, 0.37, 0.37, columns=28, rows=14).moved(x=2.72).painted(glass),
        torus(0.39, 0.04, 36, 8).turned(y=90).moved(x=2.6).painted(steel),
        ellipsoid(0.55, 0.24, 0.36, squareness=0.5, columns=32, rows=14).moved(0.35, 0, 0.52).painted(yellow),
        rounded_box(0.5, 0.26, 0.05, 0.02, 2).moved(0.35, 0, 0.86).painted(coral),
        tube([(0.25, 0, 0.85), (0.25, 0, 1.0)], 0.03, 10).painted(steel),
        tube([(0.45, 0, 0.85), (0.45, 0, 1.02), (0.5, 0, 1.06), (0.58, 0, 1.06)], 0.025, 10).painted(steel),
        sphere(0.035, 12, 8).moved(0.25, 0, 1.02).painted(light),
    ]
    parts += mirrored([part for x in (-0.1, 0.7, 1.25) for part in porthole(x, steel, glass)])
    parts += mirrored(
        [
            lathe([(0, 0), (0.07, 0), (0.08, 0.04), (0.05, 0.07), (0, 0.075)], 20)
            .turned(y=90)
            .moved(2.35, 0.38, -0.28)
            .painted(light)
        ]
    )
    fin = [(-2.2, 0.0), (-2.75, 0.0), (-2.85, 0.62), (-2.55, 0.62)]
    for turn in (0, 90, 180, 270):
        parts.append(prism(fin, 0.05).moved(z=-0.025).turned(x=90).turned(x=turn).painted(coral))
    parts += mirrored([prism([(1.7, 0.4), (2.05, 0.4), (1.95, 0.6), (1.75, 0.6)], 0.04).painted(coral)])
    parts += [
        blade(0.36, 0.16, 0.02).turned(x=20).turned(y=90).turned(x=angle).moved(x=-2.93).painted(steel)
        for angle in (0, 60, 120)
    ]
    parts += [lathe([(0, 0), (0.1, 0.0), (0.1, 0.12), (0.0, 0.22)], 20).turned(y=-90).moved(x=-2.82).painted(black)]
    parts += [cylinder(0.02, 4.2, 0.005, 10).turned(y=90).moved(0.1, y, -0.52).painted(black) for y in (-0.2, 0.2)]
    return parts


def porthole(x: float, steel, glass) -> list[Part]:
    angle = np.radians(18)
    at = (x, 0.5 * np.cos(angle), 0.5 * np.sin(angle))
    pane = [cylinder(0.11, 0.03, 0.008, 24).painted(glass), torus(0.115, 0.022, 24, 8).painted(steel)]
    return [p.turned(x=-90 + 18).moved(*at) for p in pane]
