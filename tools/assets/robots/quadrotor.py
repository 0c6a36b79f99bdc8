"""A quadrotor for teaching and games, with guards around its propellers and a boom in front."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from common.colors import CORAL, CREAM, NAVY, STEEL, TEAL
from common.materials import material
from common.objects import empty, exact
from common.rotors import blade, motor
from common.shapes import cylinder, ellipsoid, rounded_box, sphere, tube

if TYPE_CHECKING:
    from common.parts import Part

ARM = 0.131  # distance of each propeller from the centre, along X and along Y
GUARD = 0.163


def build() -> None:
    root = empty("QUAD2012", physics_type="NO_COLLISION")
    black, steel, coral = (
        material("Black", NAVY, 0.5),
        material("Steel", STEEL, 0.35, 0.9),
        material("Coral", CORAL, 0.45),
    )
    body = [part.moved(-0.041, -0.03, -0.113) for part in airframe(black, steel, coral)]
    exact(
        "Cube.016",
        body,
        (0.6, 0.6, 0.206),
        (-0.04, -0.032, -0.01),
        (0.041, 0.03, 0.113),
        parent=root,
        physics_type="NO_COLLISION",
    )
    for name, at, size, turn in (
        ("Cube.007", (-0.13, -0.132, 0.115), (0.2, 0.01, 0.001), 0),
        ("Cube.008", (0.132, 0.128, 0.115), (0.2, 0.01, 0.001), 0),
        ("Cube.009", (0.132, -0.131, 0.115), (0.149, 0.148, 0.001), 45),
        ("Cube.010", (-0.129, 0.128, 0.115), (0.148, 0.149, 0.001), -45),
    ):
        exact(
            name,
            [blade(0.1, 0.018, 0.001, turn).painted(black)],
            size,
            (0, 0, 0),
            at,
            parent=root,
            physics_type="STATIC",
            collision="box",
        )
    boom = [
        cylinder(0.005, 0.6, 0.001, 12).painted(steel),
        cylinder(0.005, 0.06, 0.001, 12).moved(z=0.265).painted(coral),
    ]
    exact(
        "Cylinder",
        boom,
        (0.01, 0.01, 0.6),
        (0, 0, 0),
        (0.316, 0.002, 0.049),
        (math.pi, math.pi / 2, math.pi),
        parent=root,
        physics_type="STATIC",
    )


def guard(front: int, side: int) -> Part:
    """The outer arc of a ring, up to its intersections with the rings of the two neighbours."""
    crossing = np.arccos(ARM / GUARD)
    angles = np.linspace(crossing - np.pi / 2, np.pi - crossing, 27)
    return tube([(front * GUARD * np.cos(a), side * GUARD * np.sin(a), 0.0) for a in angles], 0.006, 8)


def airframe(black, steel, coral) -> list:
    """The quadrotor, standing on z=0, 0.6 m wide."""
    shell, cream = material("Shell", TEAL, 0.35), material("Cream", CREAM, 0.4)
    glass, eye = material("Glass", "#0d161d", 0.1), material("Eye", "#bff4ff", 0.3, glow=1.2)
    parts = [
        ellipsoid(0.11, 0.085, 0.055, squareness=0.3, columns=32, rows=16).moved(z=0.1).painted(shell),
        ellipsoid(0.07, 0.055, 0.03, squareness=0.2, columns=28, rows=10).moved(-0.01, 0, 0.145).painted(cream),
        rounded_box(0.04, 0.08, 0.034, 0.016, 2).moved(0.088, 0, 0.095).painted(glass),
        tube([(-0.05, 0, 0.16), (-0.05, 0, 0.2)], 0.003, 6).painted(steel),
        sphere(0.006, 8, 6).moved(-0.05, 0, 0.2).painted(coral),
    ]
    for side in (1, -1):
        parts.append(ellipsoid(0.004, 0.009, 0.012, columns=12, rows=6).moved(0.108, side * 0.019, 0.098).painted(eye))
        skid = [(0.1, 0), (0.12, 0.004), (0.14, 0.02)]
        runner = [(-x, side * 0.08, z + 0.005) for x, z in reversed(skid)] + [
            (x, side * 0.08, z + 0.005) for x, z in skid
        ]
        parts.append(tube(runner, 0.005, 8).painted(black))
        parts += [
            tube([(x, side * 0.08, 0.005), (x * 0.8, side * 0.05, 0.07)], 0.004, 8).painted(black)
            for x in (0.07, -0.07)
        ]
        for front in (1, -1):
            x, y = front * ARM, side * ARM
            parts.append(tube([(front * 0.05, side * 0.05, 0.1), (x, y, 0.097)], 0.008, 8).painted(cream))
            parts += [p.moved(x, y, 0.09) for p in motor(0.014, 0.034, steel, black)]
            parts.append(guard(front, side).moved(x, y, 0.113).painted(coral if front > 0 else cream))
            parts += [
                tube([(x, y, 0.1), (x + dx, y + dy, 0.113)], 0.0035, 6).painted(black)
                for dx, dy in ((front * GUARD, 0), (0, side * GUARD))
            ]
    return parts
