"""A small unmanned helicopter; its nose points along +X."""

from __future__ import annotations

import numpy as np
from common.colors import CREAM, NAVY, STEEL
from common.materials import material
from common.objects import exact
from common.parts import Part, mirrored
from common.rotors import blade
from common.shapes import box, cylinder, ellipsoid, lathe, prism, rounded_box, tube


def build() -> None:
    black, steel = material("Black", NAVY, 0.5), material("Steel", STEEL, 0.35, 0.9)
    root = exact(
        "Rmax", fuselage(black, steel), (2.73, 0.375, 0.88), (-0.536, 0, 0.44), physics_type="STATIC", collision="box"
    )
    rotor = [
        blade(1.545, 0.05, 0.008).moved(z=1.04).painted(black),
        *(
            box(0.12, 0.045, 0.009, 0.002).moved(s * 1.4, 0, 1.04).painted(material(f"Tip {n}", "#f2c230", 0.5))
            for n, s in enumerate((1, -1))
        ),
        cylinder(0.018, 0.2, 0.003, 16).moved(z=0.93).painted(steel),
        rounded_box(0.16, 0.05, 0.04, 0.015, 2).moved(z=1.035).painted(steel),
        tube([(-0.2, 0, 0.95), (0.2, 0, 0.95)], 0.008, 8).painted(steel),
    ]
    exact(
        "Rotor",
        rotor,
        (3.09, 0.05, 0.25),
        (0.006, 0, 0.956),
        (0, 0, 0.023),
        parent=root,
        physics_type="STATIC",
        collision="box",
        animateRotor=True,
    )


def fuselage(black, steel) -> list[Part]:
    red, cream = material("Shell", "#c8262c", 0.35), material("Cream", CREAM, 0.4)
    glass = material("Glass", "#16242e", 0.08)
    spine = np.array(
        [
            (0.83, 0.40, 0.03),
            (0.74, 0.42, 0.11),
            (0.5, 0.46, 0.165),
            (0.15, 0.5, 0.185),
            (-0.2, 0.51, 0.17),
            (-0.5, 0.53, 0.10),
            (-0.75, 0.55, 0.055),
        ]
    )
    path = [(x, 0.0, z) for x, z, _ in spine]
    parts = [
        tube(path, [r for *_, r in spine], 24).scaled(1, 1, 1).painted(red),
        tube([(-0.7, 0, 0.55), (-1.75, 0, 0.58)], [0.045, 0.028], 14).painted(cream),
        ellipsoid(0.22, 0.125, 0.10, columns=24, rows=12).moved(0.52, 0, 0.53).painted(glass),
        rounded_box(0.42, 0.26, 0.16, 0.05, 2).moved(-0.05, 0, 0.34).painted(black),
        lathe([(0, 0.62), (0.10, 0.62), (0.07, 0.74), (0.03, 0.86), (0, 0.86)], 20).moved(0, 0, 0).painted(steel),
        rounded_box(0.2, 0.1, 0.1, 0.03, 2).moved(0.62, 0, 0.25).painted(black),  # sensor under the nose
        cylinder(0.035, 0.03, 0.006, 16).turned(y=90).moved(0.725, 0, 0.25).painted(glass),
    ]
    fin = [(-1.62, 0.56), (-1.72, 0.36), (-1.80, 0.36), (-1.86, 0.60), (-1.90, 0.86), (-1.78, 0.86)]
    parts += [
        prism(fin, 0.02).moved(z=-0.01).turned(x=90).painted(red),
        blade(0.22, 0.035, 0.008, 40).turned(x=90).moved(-1.80, -0.045, 0.58).painted(black),
        cylinder(0.02, 0.06, 0.004, 12).turned(x=90).moved(-1.80, -0.03, 0.58).painted(steel),
        box(0.16, 0.34, 0.012, 0.004).moved(-1.42, 0, 0.575).painted(red),
    ]
    skid = [(0.55, 0.10), (0.48, 0.03), (0.4, 0.012), (-0.45, 0.012)]
    landing = [tube([(x, 0.175, z) for x, z in skid], 0.012, 10).painted(steel)]
    landing += [
        tube([(x, 0.175, 0.012), (x, 0.15, 0.12), (x, 0.08, 0.32)], 0.01, 8).painted(steel) for x in (0.25, -0.3)
    ]
    stripe = box(0.5, 0.008, 0.04, 0.002).moved(0.05, 0.183, 0.50).painted(cream)
    return [*parts, *mirrored([*landing, stripe])]
