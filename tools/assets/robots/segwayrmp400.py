"""A heavy platform on four driven wheels."""

from __future__ import annotations

import math

from common.colors import CREAM, NAVY, RUBBER, STEEL, SUN
from common.materials import material
from common.objects import exact
from common.parts import mirrored
from common.shapes import box, cylinder, lathe, rounded_box, tube
from common.wheels import dish, tread_tyre

PI = math.pi
WHEELS = (("wheel1", 1, 1), ("wheel2", 1, -1), ("wheel3", -1, 1), ("wheel4", -1, -1))


def build() -> None:
    rubber, cream, black = material("Rubber", RUBBER, 0.9), material("Cream", CREAM, 0.4), material("Black", NAVY, 0.5)
    # two plates: their hull is the collision shape, and the chassis is visible between them
    core = [box(0.9, 0.4, 0.03, 0.008).moved(z=z).painted(black) for z in (-0.0625, 0.2625)]
    root = exact(
        "segwayrmp400",
        core,
        (0.9, 0.4, 0.355),
        (0, 0, 0.1),
        (0, 0, 0.15),
        physics_type="RIGID_BODY",
        collision="convex",
        mass=90.0,
        FixTurningSpeed=1.16,
    )
    exact(
        "rmp400_chassis",
        chassis(cream, black),
        (0.969, 0.521, 0.355),
        (0, 0, 0.1),
        (0, 0, 0.15),
        parent=root,
        physics_type="NO_COLLISION",
    )
    for name, front, side in WHEELS:
        # the outer side of the left wheels is the -Z of their axis
        wheel = [*tread_tyre(0.25, 0.168, 0.14, rubber, 18), *dish(0.14, 0.15, cream, black)]
        parts = [p.turned(x=90 + 90 * side) for p in wheel]
        exact(
            name,
            parts,
            (0.5, 0.5, 0.168),
            (0, 0, 0),
            (0.27 * front, 0.312 * side, 0.25),
            (PI / 2, 0, 0),
            parent=root,
            physics_type="RIGID_BODY",
            collision="cylinder",
            mass=5.5,
        )


def chassis(cream, black) -> list:
    """Sizes relative to the root, 0.15 m above the ground."""
    yellow = material("Shell", SUN, 0.4)
    steel = material("Steel", STEEL, 0.35, 0.9)
    glass, light = material("Glass", "#0d161d", 0.1), material("Lamp", "#fff3cf", 0.2, glow=1.2)
    parts = [
        rounded_box(0.94, 0.45, 0.13, 0.05, 3).moved(z=0.03).painted(yellow),
        rounded_box(0.90, 0.42, 0.13, 0.045, 3).moved(z=0.165).painted(cream),
        rounded_box(0.95, 0.521, 0.03, 0.012, 2).moved(z=0.245).painted(steel),
        box(0.5, 0.43, 0.05, 0.01).moved(z=-0.045).painted(black),
        cylinder(0.1, 0.025, 0.006, 32).moved(-0.1, 0, 0.265).painted(black),
    ]
    parts += mirrored(
        [
            tube([(-0.4, 0.2, 0.2), (-0.4, 0.2, 0.25)], 0.025, 12, round_ends=False).painted(steel),
            tube([(0.4, 0.2, 0.2), (0.4, 0.2, 0.25)], 0.025, 12, round_ends=False).painted(steel),
            lathe([(0, 0), (0.042, 0.0), (0.042, 0.01), (0.03, 0.018), (0, 0.02)], 20)
            .turned(y=90)
            .moved(0.463, 0.12, 0.045)
            .painted(light),
            box(0.012, 0.06, 0.018, 0.003).moved(0.45, 0.06, 0.14).painted(glass),
            box(0.7, 0.006, 0.02, 0.002).moved(0, 0.212, 0.145).painted(yellow),
        ]
    )
    parts += [rounded_box(0.05, 0.44, 0.06, 0.024, 2).moved(s * 0.46, 0, -0.01).painted(black) for s in (1, -1)]
    return parts
