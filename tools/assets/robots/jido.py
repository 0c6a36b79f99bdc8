"""A mobile base with a mast, a screen and two laser scanners."""

from __future__ import annotations

import math

from common.colors import CREAM, NAVY, RUBBER, SKY, STEEL
from common.materials import material
from common.objects import empty, exact
from common.parts import in_frame_of, mirrored
from common.shapes import box, cylinder, lathe, prism, rounded_box, sphere, tube
from common.wheels import caster, dish, tyre

PI = math.pi


def build() -> None:
    blue, cream, black = material("Shell", "#2c5f9e", 0.35), material("Cream", CREAM, 0.4), material("Black", NAVY, 0.4)
    steel, rubber = material("Steel", STEEL, 0.35, 0.9), material("Rubber", RUBBER, 0.85)
    root = empty("Jido", physics_type="STATIC")
    base = exact(
        "JidoBase",
        body(blue, cream, black, steel),
        (0.707, 0.66, 1.62),
        (-0.009, 0, 0.859),
        parent=root,
        physics_type="STATIC",
        collision="convex",
    )
    show = {"parent": base, "physics_type": "NO_COLLISION"}
    computer = [rounded_box(0.346, 0.453, 0.183, 0.03, 2).painted(cream)]
    computer += [box(0.008, 0.30, 0.012, 0.002).moved(0.171, 0, z).painted(black) for z in (-0.04, -0.015, 0.01)]
    exact("Computer", computer, (0.346, 0.453, 0.183), (-0.111, 0.007, 0.693), **show)
    display = material("Display", SKY, 0.2, glow=0.8)
    pane = [
        rounded_box(0.05, 0.265, 0.215, 0.02, 2).painted(black),
        rounded_box(0.02, 0.225, 0.175, 0.009, 1).moved(x=0.026).painted(display),
    ]
    exact(
        "FrontScreen",
        pane,
        (0.061, 0.265, 0.215),
        (0, 0, 0),
        (-0.139, 0.003, 1.4),
        parent=base,
        physics_type="STATIC",
        collision="box",
    )
    drive = mirrored(
        [
            p.turned(x=-90).moved(0, 0.3, 0.09)
            for p in (*tyre(0.0905, 0.05, 0.055, rubber), *dish(0.055, 0.045, steel, black))
        ]
    )
    exact("MotorWheels", drive, (0.182, 0.656, 0.181), (0, 0, 0.091), **show)
    lasers = scanner(material("Scanner", "#2f6fd0", 0.4), black)
    pair = [*lasers, *(p.turned(z=180) for p in lasers)]
    exact("Sicks", pair, (0.829, 0.202, 0.191), (0, 0, 0.091), (0.017, 0, 0.204), (0, 0, -PI), **show)
    small = [p.turned(x=90) for p in caster(0.05, 0.035, rubber, steel)]
    small += [
        box(0.05, 0.05, 0.05, 0.006).moved(z=0.085).painted(steel),
        cylinder(0.02, 0.05, columns=16).moved(z=0.11).painted(steel),
    ]
    feet = [p.moved(x, y, 0.05) for x in (-0.32, 0.32) for y in (-0.2, 0.2) for p in small]
    feet = in_frame_of(feet, (-PI / 2, PI / 2, 0))
    exact("Wheels", feet, (0.161, 0.751, 0.472), (-0.081, 0.041, 0), (0, 0, 0), (-PI / 2, PI / 2, 0), **show)


def scanner(blue, black) -> list:
    """One laser scanner that faces +X, its front at x=0.41."""
    return [
        rounded_box(0.13, 0.2, 0.09, 0.02, 2).moved(0.33, 0, 0.046).painted(blue),
        rounded_box(0.11, 0.18, 0.05, 0.02, 2).moved(0.32, 0, 0.165).painted(blue),
        lathe([(0, 0.085), (0.085, 0.085), (0.085, 0.145), (0, 0.145)], 32).moved(0.33, 0, 0).painted(black),
    ]


def body(blue, cream, black, steel) -> list:
    outline = [
        (-0.33, -0.2),
        (-0.24, -0.29),
        (0.24, -0.29),
        (0.33, -0.2),
        (0.33, 0.2),
        (0.24, 0.29),
        (-0.24, 0.29),
        (-0.33, 0.2),
    ]
    parts = [
        prism(outline, 0.14).moved(z=0.05).painted(black),
        prism(outline, 0.16).moved(z=0.40).painted(blue),
        rounded_box(0.44, 0.50, 0.26, 0.04, 2).moved(-0.02, 0, 0.30).painted(cream),
        rounded_box(0.64, 0.60, 0.04, 0.018, 2).moved(-0.01, 0, 0.58).painted(blue),
        rounded_box(0.12, 0.30, 0.56, 0.045, 3).moved(-0.22, 0, 1.02).painted(blue),  # mast
        rounded_box(0.10, 0.22, 0.30, 0.04, 2).moved(-0.20, 0, 1.40).painted(black),
    ]
    parts += mirrored(
        [
            tube(
                [
                    (-0.34, 0.30, 0.58),
                    (-0.34, 0.30, 0.86),
                    (-0.30, 0.30, 0.9),
                    (-0.1, 0.30, 0.9),
                    (-0.06, 0.30, 0.86),
                    (-0.06, 0.30, 0.58),
                ],
                0.016,
                10,
            ).painted(steel)
        ]
    )
    # a head with two cameras above the screen
    eye, gleam = material("Lens", "#0d161d", 0.1), material("Gleam", "#ffffff", 0.3, glow=1.0)
    parts += [
        cylinder(0.03, 0.12, 0.004, 20).moved(-0.19, 0, 1.56).painted(steel),
        rounded_box(0.12, 0.27, 0.10, 0.045, 3).moved(-0.17, 0, 1.62).painted(cream),
    ]
    for side in (1, -1):
        parts += [
            cylinder(0.034, 0.02, 0.006, 24).turned(y=90).moved(-0.11, side * 0.07, 1.62).painted(eye),
            sphere(0.008, 8, 6).moved(-0.099, side * 0.07 + 0.01, 1.632).painted(gleam),
        ]
    stop = material("Stop", "#e1261c", 0.4)
    parts.append(cylinder(0.03, 0.03, 0.008, 20).moved(-0.28, 0.2, 0.61).painted(stop))
    return parts
