"""A small robot for laboratories: two driven wheels and a caster."""

from __future__ import annotations

import math

import numpy as np
from common.colors import NAVY, RUBBER, STEEL
from common.materials import material
from common.objects import exact
from common.parts import mirrored
from common.shapes import box, cylinder, lathe, prism, rounded_box, torus
from common.wheels import caster, dish, tyre

PI = math.pi


def build() -> None:
    rubber, steel = material("Rubber", RUBBER, 0.85), material("Steel", STEEL, 0.3, 0.9)
    black = material("Black", NAVY, 0.4)
    root = exact(
        "Pioneer",
        body(black, steel),
        (0.456, 0.367, 0.181),
        (0, 0, 0.059),
        (0, 0, 0.1),
        physics_type="RIGID_BODY",
        collision="box",
        mass=9.0,
        FixTurningSpeed=0.52,
        Influence=0.1,
        Friction=0.8,
        HasSuspension=True,
    )
    for name, side in (("Wheel_L", 1), ("Wheel_R", -1)):
        # both wheels rotate about the same axis; the outer side of the left one is -Z, that of the right one +Z
        wheel = [*tyre(0.0975, 0.05, 0.06, rubber), *dish(0.06, 0.052, steel, black)]
        parts = [p.turned(x=90 + 90 * side).moved(z=-0.001 * side) for p in wheel]
        exact(
            name,
            parts,
            (0.195, 0.195, 0.053),
            (0, 0, -0.001 * side),
            (0.045, side * 0.171, 0.1),
            (PI / 2, 0, 0),
            parent=root,
            physics_type="RIGID_BODY",
            collision="cylinder",
            mass=1.0,
        )
    exact(
        "CasterWheel",
        caster(0.038, 0.031, rubber, steel),
        (0.077, 0.077, 0.031),
        (0, 0, 0),
        (-0.17, 0, 0.043),
        (PI / 2, 0, 0),
        parent=root,
        physics_type="RIGID_BODY",
        collision="cylinder",
        mass=1.0,
    )
    fork = [
        *mirrored([box(0.03, 0.004, 0.062, 0.001).turned(y=20).moved(0.012, 0.0195, 0.02)]),
        cylinder(0.02, 0.012, 0.002, 20).moved(0.018, 0, 0.054),
        cylinder(0.012, 0.014, 0.002, 16).moved(0.018, 0, 0.064),
    ]
    exact(
        "Swivel",
        [p.painted(steel) for p in fork],
        (0.05, 0.043, 0.081),
        (0.014, 0, 0.03),
        (-0.17, 0, 0.043),
        parent=root,
        physics_type="NO_COLLISION",
    )


def outline(length: float, width: float, cut: float) -> list[tuple[float, float]]:
    """A rectangle whose ends are arcs."""
    angles = np.radians(np.linspace(-62, 62, 17))
    bulge = width / 2 / np.sin(np.radians(62))
    arc = [(length / 2 - bulge + bulge * np.cos(a) - cut, bulge * np.sin(a)) for a in angles]
    return arc + [(-x, -y) for x, y in arc]


def body(black, steel) -> list:
    """Sizes relative to the axle, 0.1 m above the ground."""
    red, gold = material("Shell", "#c8202f", 0.3), material("Sonar", "#c9a24a", 0.35, 0.8)
    green = material("Power", "#57e06a", 0.3, glow=1.2)
    glass = material("Glass", "#0d161d", 0.1)
    deck = prism(outline(0.456, 0.367, 0.0), 0.012)
    parts = [
        deck.moved(z=0.128).painted(black),
        prism(outline(0.44, 0.345, 0.0), 0.05).moved(z=0.078).painted(black),  # sonar band
        prism(outline(0.424, 0.25, 0.0), 0.11).moved(z=-0.031).painted(red),
        rounded_box(0.2, 0.27, 0.10, 0.02, 2).moved(-0.02, 0, 0.03).painted(red),
        rounded_box(0.30, 0.2, 0.014, 0.006, 1).moved(0.0, 0, 0.142).painted(steel),
    ]
    for angle in np.radians([-52, -37, -22, -7, 7, 22, 37, 52]):
        for end in (0, 180):
            bulge = 0.345 / 2 / np.sin(np.radians(62))
            x, y = 0.22 - bulge + bulge * np.cos(angle), bulge * np.sin(angle)
            disc = [
                cylinder(0.017, 0.008, 0.001, 20).painted(gold),
                torus(0.0175, 0.003, 20, 6).moved(z=0.003).painted(steel),
            ]
            parts += [p.turned(y=90).turned(z=np.degrees(angle)).moved(x, y, 0.103).turned(z=end) for p in disc]
    # a face: two dark eyes above a vent, and the power light
    for side in (1, -1):
        eye = lathe([(0, 0), (0.018, 0), (0.02, 0.004), (0.014, 0.009), (0, 0.011)], 20)
        parts.append(eye.turned(y=90).moved(0.206, side * 0.045, 0.042).painted(glass))
    parts += [box(0.006, 0.09, 0.004, 0.001).moved(0.212, 0, z).painted(black) for z in (0.006, -0.004, -0.014)]
    parts.append(cylinder(0.007, 0.008, 0.002, 12).moved(-0.10, 0.13, 0.142).painted(green))
    return parts
