"""An upright arm of six joints in a row; each part is attached to the one below and turns about its own origin."""

from __future__ import annotations

from common.colors import CREAM, NAVY, STEEL
from common.materials import material
from common.objects import exact
from common.shapes import cylinder, lathe, rounded_box, torus, tube


def build() -> None:
    cream, black, steel = (
        material("Shell", CREAM, 0.35),
        material("Black", NAVY, 0.45),
        material("Steel", STEEL, 0.3, 0.9),
    )
    base = [
        lathe([(0, 0), (0.117, 0.0), (0.117, 0.02), (0.095, 0.03), (0.09, 0.19), (0, 0.199)], 40).painted(cream),
        torus(0.093, 0.008, 40, 8).moved(z=0.17).painted(black),
        *(
            cylinder(0.008, 0.01, 0.002, 10).moved(0.105, 0, 0.022).turned(z=a).painted(steel)
            for a in range(0, 360, 45)
        ),
    ]
    shoulder = [
        lathe([(0, 0.2), (0.088, 0.2), (0.088, 0.25), (0, 0.25)], 36).painted(black),
        rounded_box(0.2, 0.16, 0.13, 0.05, 3).moved(z=0.31).painted(cream),
        cylinder(0.07, 0.26, 0.01, 32).turned(x=90).moved(z=0.317).painted(cream),
        cylinder(0.045, 0.264, 0.004, 28).turned(x=90).moved(z=0.317).painted(black),
    ]
    upper = [
        rounded_box(0.13, 0.15, 0.16, 0.05, 3).moved(-0.02, 0, 0.0).painted(cream),
        tube([(-0.05, 0, 0.03), (-0.05, 0, 0.4)], [0.075, 0.055], 24).painted(cream),
        cylinder(0.06, 0.19, 0.01, 28).turned(x=90).moved(-0.01, 0, 0.45).painted(cream),
        cylinder(0.04, 0.213, 0.004, 24).turned(x=90).moved(-0.01, 0, 0.45).painted(black),
        rounded_box(0.05, 0.06, 0.2, 0.02, 2).moved(-0.13, 0, 0.2).painted(black),
    ]
    elbow = [
        tube([(0, 0, 0.0), (0, 0, 0.24)], [0.058, 0.045], 24).painted(cream),
        torus(0.05, 0.006, 28, 8).moved(z=0.2).painted(black),
    ]
    fore = [
        rounded_box(0.088, 0.10, 0.1, 0.035, 3).moved(z=0.0).painted(cream),
        tube([(0, 0, 0.02), (0, 0, 0.15)], [0.04, 0.034], 20).painted(cream),
        cylinder(0.032, 0.162, 0.004, 24).turned(x=90).moved(z=0.0).painted(black),
    ]
    wrist = [
        tube([(0, 0, -0.05), (0, 0, 0.03)], [0.045, 0.045], 24).painted(cream),
        torus(0.045, 0.004, 24, 8).moved(z=0.0).painted(steel),
    ]
    hand = [
        cylinder(0.045, 0.05, 0.006, 28).moved(z=0.01).painted(steel),
        cylinder(0.03, 0.079, 0.003, 24).moved(z=0.015).painted(black),
        rounded_box(0.12, 0.05, 0.05, 0.02, 2).moved(-0.08, 0.03, 0.01).painted(cream),
        cylinder(0.02, 0.06, 0.003, 20).turned(x=90).moved(-0.12, 0.07, 0.01).painted(black),
    ]
    parent = None
    for name, parts, z, size, centre in (
        ("PA10", base, 0.0, (0.234, 0.246, 0.199), (0, 0.006, 0.1)),
        ("PA10-1", shoulder, 0.0, (0.219, 0.26, 0.187), (0, 0, 0.295)),
        ("PA10-2", upper, 0.317, (0.234, 0.213, 0.581), (-0.046, 0, 0.219)),
        ("PA10-3", elbow, 0.767, (0.12, 0.119, 0.343), (0, 0, 0.114)),
        ("PA10-4", fore, 1.1, (0.088, 0.162, 0.241), (0, 0, 0.071)),
        ("PA10-5", wrist, 1.25, (0.096, 0.097, 0.158), (0, 0, -0.01)),
        ("PA10-6", hand, 1.34, (0.185, 0.154, 0.079), (-0.047, 0.032, 0.015)),
    ):
        parent = exact(name, parts, size, centre, (0, 0, z), parent=parent, physics_type="STATIC", collision="convex")
