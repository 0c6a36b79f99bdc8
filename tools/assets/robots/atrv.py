"""A four-wheeled robot for rough ground."""

from __future__ import annotations

import math

from common.colors import CREAM, NAVY, RUBBER, STEEL, SUN
from common.materials import material
from common.objects import exact, hidden_box
from common.parts import mirrored
from common.shapes import box, cylinder, lathe, prism, rounded_box, sphere, torus, tube
from common.wheels import dish, tread_tyre

PI = math.pi
WHEELS = (
    ("Wheel.1", (0.338, 0.547, 0.204), (PI / 2, 0, PI)),
    ("Wheel.2", (0.337, -0.543, 0.204), (PI / 2, 0, 0)),
    ("Wheel.3", (-0.288, -0.543, 0.203), (PI / 2, 0, 0)),
    ("Wheel.4", (-0.288, 0.547, 0.203), (PI / 2, 0, PI)),
)


def build() -> None:
    rubber, rim = material("Rubber", RUBBER, 0.9), material("Rim", CREAM, 0.4)
    black = material("Black", NAVY, 0.45)
    root = exact(
        "ATRV",
        body(rim, black),
        (1.14, 0.671, 0.731),
        (0, 0, 0.372),
        (0, 0, 0.1),
        physics_type="RIGID_BODY",
        collision="convex",
        compound=1,
        mass=20.0,
        linear_damping=0.025,
        angular_damping=0.18,
    )
    # the wheels do not collide: this box supports the robot, with its origin 0.1 m above the ground
    hidden_box("ATRV_bb", (0.92, 0.99, 0.36), (0.025, 0, 0.18), parent=root, physics_type="RIGID_BODY", mass=1.0)
    for name, at, turned in WHEELS:
        wheel = [*tread_tyre(0.2, 0.16, 0.11, rubber), *dish(0.11, 0.13, rim, black)]
        # the outer side of a wheel is its local +Z, the hull is on the other side
        exact(
            name,
            [p.moved(z=-0.128) for p in wheel],
            (0.403, 0.403, 0.16),
            (0, 0, -0.128),
            at,
            turned,
            parent=root,
            physics_type="NO_COLLISION",
        )


def body(cream, black) -> list:
    """Sizes relative to the origin of the robot, 0.1 m above the ground."""
    shell = material("Shell", "#d8412f", 0.35)
    steel = material("Steel", STEEL, 0.3, 0.9)
    glass = material("Glass", "#0d161d", 0.1)
    light = material("Headlight", "#fff3cf", 0.2, glow=1.2)
    beacon = material("Beacon", SUN, 0.3, glow=1.0)
    hull = [
        (-0.5, 0.05),
        (0.46, 0.05),
        (0.55, 0.17),
        (0.55, 0.32),
        (0.43, 0.44),
        (-0.49, 0.44),
        (-0.55, 0.36),
        (-0.55, 0.12),
    ]
    parts = [
        prism(hull, 0.56).moved(z=-0.28).turned(x=90).painted(shell),
        rounded_box(1.06, 0.64, 0.14, 0.05, 2).moved(0, 0, 0.30).painted(shell),
        rounded_box(0.82, 0.52, 0.05, 0.02, 2).moved(-0.03, 0, 0.452).painted(cream),
        rounded_box(0.30, 0.40, 0.11, 0.045, 3).moved(-0.22, 0, 0.51).painted(black),  # electronics
        rounded_box(0.10, 0.52, 0.09, 0.035, 2).moved(0.53, 0, 0.115).painted(black),  # bumpers
        rounded_box(0.08, 0.52, 0.09, 0.035, 2).moved(-0.535, 0, 0.14).painted(black),
        box(0.30, 0.56, 0.10, 0.02).moved(0.0, 0, 0.075).painted(black),
    ]
    parts += mirrored(
        [
            lathe([(0, 0), (0.045, 0), (0.05, 0.012), (0.04, 0.022), (0, 0.024)], 20)
            .turned(y=90)
            .moved(0.545, 0.17, 0.265)
            .painted(light),
            torus(0.05, 0.012, 24, 8).turned(y=90).moved(0.553, 0.17, 0.265).painted(steel),
            tube(
                [
                    (0.33, 0.22, 0.45),
                    (0.33, 0.22, 0.56),
                    (0.28, 0.22, 0.6),
                    (-0.36, 0.22, 0.6),
                    (-0.42, 0.22, 0.55),
                    (-0.42, 0.22, 0.45),
                ],
                0.014,
                10,
            ).painted(steel),
            box(0.5, 0.012, 0.05, 0.004).moved(0.02, 0.324, 0.30).painted(cream),
        ]
    )
    # a row of range finders in the nose, two eyes in a head
    parts += [
        cylinder(0.022, 0.012, 0.003, 16).turned(y=90).moved(0.551, y, 0.205).painted(glass) for y in (-0.08, 0.0, 0.08)
    ]
    parts += [
        cylinder(0.03, 0.12, 0.005, 16).moved(0.2, 0, 0.53).painted(steel),
        rounded_box(0.11, 0.26, 0.10, 0.045, 3).moved(0.21, 0, 0.625).painted(cream),
    ]
    for side in (1, -1):
        parts += [
            cylinder(0.036, 0.03, 0.008, 24).turned(y=90).moved(0.262, side * 0.065, 0.628).painted(black),
            sphere(0.027, 16, 8).scaled(0.5, 1, 1).moved(0.276, side * 0.065, 0.628).painted(glass),
            sphere(0.008, 8, 6).moved(0.287, side * 0.065 + 0.009, 0.639).painted(light),
        ]
    parts += [
        lathe([(0, 0), (0.035, 0.0), (0.035, 0.03), (0.02, 0.05), (0, 0.055)], 16)
        .moved(-0.22, 0.1, 0.56)
        .painted(beacon),
        tube([(-0.3, -0.13, 0.55), (-0.3, -0.13, 0.72)], 0.006, 8).painted(steel),
        sphere(0.013, 10, 6).moved(-0.3, -0.13, 0.725).painted(black),
    ]
    return parts
