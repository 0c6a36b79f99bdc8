"""A large off-road vehicle. As in MORSE 1.4, it drives along its own Y axis; at rest that is the world's X."""

from __future__ import annotations

import math

from common.colors import NAVY, RUBBER, STEEL, SUN
from common.materials import material
from common.objects import exact, hidden_box
from common.parts import mirrored
from common.shapes import box, cylinder, lathe, prism, rounded_box, torus, tube
from common.wheels import dish, tread_tyre

HEADING = (0.0, 0.0, -math.pi / 2)
FRONT, REAR, SIDE, HEIGHT = 1.6, -2.3, 1.3, -0.5


def build() -> None:
    rubber, steel, black = (
        material("Rubber", RUBBER, 0.9),
        material("Steel", STEEL, 0.35, 0.9),
        material("Black", NAVY, 0.5),
    )
    body = [part.turned(z=90) for part in [*shell(black), *details(steel, black), *spare(rubber, steel, black)]]
    root = exact(
        "Hummer", body, (2.66, 5.5, 1.9), (0.021, -0.484, 0.423), turned=HEADING,
        physics_type="RIGID_BODY", collision="convex", compound=1, mass=10.0,
    )  # fmt: skip
    # supports the car instead of the wheels, which do not collide, until an actuator does
    hidden_box("Hummer_bb", (4.86, 2.9, 0.5), (-0.35, 0, -0.73), parent=root, physics_type="RIGID_BODY", mass=1.0)
    for name, x, side in (("wheel1", FRONT, 1), ("wheel2", FRONT, -1), ("wheel3", REAR, 1), ("wheel4", REAR, -1)):
        wheel = [*tread_tyre(0.48, 0.48, 0.27, rubber, 22), *dish(0.27, 0.40, steel, black, 8)]
        parts = [part.turned(y=-90 * side) for part in wheel]  # the axle is the local X axis, the left side its -X
        exact(
            name,
            parts,
            (0.48, 0.959, 0.959),
            (0, 0, 0),
            (x, SIDE * side, HEIGHT),
            HEADING,
            parent=root,
            physics_type="NO_COLLISION",
        )


def shell(black) -> list:
    """The body along +X, relative to its origin."""
    sand, glass = material("Shell", "#c9a35c", 0.45), material("Glass", "#16242e", 0.08)
    lower = [(-3.1, -0.3), (2.1, -0.3), (2.2, -0.1), (2.2, 0.25), (2.0, 0.38), (0.75, 0.5), (-3.1, 0.5)]
    cabin = [(-3.05, 0.45), (0.80, 0.45), (0.25, 1.24), (0.1, 1.28), (-2.95, 1.28), (-3.05, 1.2)]
    parts = [
        prism(lower, 2.3).moved(z=-1.15).turned(x=90).painted(sand),
        prism(cabin, 2.0).moved(z=-1.0).turned(x=90).painted(sand),
        rounded_box(5.2, 2.5, 0.24, 0.08, 2).moved(-0.48, 0, 0.36).painted(sand),
        box(4.6, 2.0, 0.25, 0.05).moved(-0.48, 0, -0.38).painted(black),
        rounded_box(1.9, 1.9, 0.08, 0.03, 2).moved(1.1, 0, 0.45).painted(sand),
    ]
    windscreen = box(0.02, 1.8, 0.66, 0.005).turned(y=-34.9).moved(0.535, 0, 0.86)
    parts += [windscreen.painted(glass), box(0.02, 1.6, 0.5, 0.005).moved(-3.055, 0, 0.88).painted(glass)]
    windows = [prism(outline, 0.02).turned(x=90).moved(0, 1.012, 0).painted(glass) for outline in side_windows()]
    arches = []
    for x in (FRONT, REAR):
        arch = [
            (
                x + 0.66 * math.cos(a),
                HEIGHT + 0.66 * math.sin(a),
            )
            for a in (math.pi * k / 12 for k in range(13))
        ]
        arches.append(tube([(u, 1.2, v) for u, v in arch], 0.11, 10).painted(black))
    return [*parts, *mirrored([*windows, *arches])]


def side_windows() -> list[list[tuple[float, float]]]:
    front = [(-0.75, 0.6), (0.55, 0.6), (0.2, 1.12), (-0.75, 1.12)]
    return [front, *([(x, 0.6), (x + 0.95, 0.6), (x + 0.95, 1.12), (x, 1.12)] for x in (-1.85, -2.95))]


def details(steel, black) -> list:
    """Lamps, grille, bumpers, roof rack."""
    light, red = material("Headlight", "#fff3cf", 0.2, glow=1.2), material("Tail Light", "#d82020", 0.3, glow=0.6)
    amber = material("Amber", SUN, 0.3, glow=1.2)
    lens = lathe([(0, 0), (0.15, 0.0), (0.15, 0.03), (0.1, 0.06), (0, 0.07)], 24).turned(y=90)
    handed = [
        lens.moved(2.19, 0.72, 0.1).painted(light),
        torus(0.16, 0.03, 28, 8).turned(y=90).moved(2.22, 0.72, 0.1).painted(steel),
        rounded_box(0.04, 0.2, 0.28, 0.015, 1).moved(-3.1, 0.95, 0.1).painted(red),
        rounded_box(0.22, 0.34, 0.22, 0.05, 2).moved(0.6, 1.2, 0.66).painted(black),  # mirrors
        tube([(0.1, 0.85, 1.36), (-2.7, 0.85, 1.36)], 0.03, 8).painted(steel),
        *(
            tube([(x, 0.85, 1.27), (x, 0.85, 1.36)], 0.025, 8, round_ends=False).painted(steel)
            for x in (0.0, -1.3, -2.6)
        ),
        box(1.0, 0.03, 0.04, 0.008).moved(-0.2, 1.26, 0.36).painted(black),
    ]
    parts = mirrored(handed)
    parts += [
        box(0.04, 0.09, 0.3, 0.012).moved(2.2, y, 0.08).painted(black)
        for y in (-0.42, -0.28, -0.14, 0, 0.14, 0.28, 0.42)
    ]
    parts += [rounded_box(0.16, 2.5, 0.2, 0.06, 2).moved(x, 0, -0.24).painted(black) for x in (2.2, -3.1)]
    parts += [box(0.06, 1.7, 0.03, 0.008).moved(x, 0, 1.34).painted(steel) for x in (-0.1, -0.75, -1.4, -2.05, -2.6)]
    parts += [
        cylinder(0.075, 0.06, 0.015, 20).turned(y=90).moved(0.16, y, 1.32).painted(amber)
        for y in (-0.5, -0.25, 0, 0.25, 0.5)
    ]
    return parts


def spare(rubber, steel, black) -> list:
    wheel = [*tread_tyre(0.4, 0.26, 0.22, rubber, 18), *dish(0.22, 0.22, steel, black)]
    return [part.turned(y=-90).moved(-3.12, -0.2, 0.45) for part in wheel]
