"""A quadrotor that flies by the forces of its propellers."""

from __future__ import annotations

from common.colors import CORAL, CREAM, NAVY, STEEL, SUN
from common.materials import material
from common.objects import exact
from common.parts import mirrored
from common.rotors import blade, motor
from common.shapes import box, cylinder, ellipsoid, lathe, rounded_box, sphere, tube

REACH = 0.24  # distance of each propeller from the centre; they form a plus


def build() -> None:
    exact(
        "Quadrotor", machine(), (0.7, 0.7, 0.197), (0, 0, -0.063),
        physics_type="RIGID_BODY", collision="convex", mass=2.0, linear_damping=0.04, angular_damping=0.1,
    )  # fmt: skip


def machine() -> list:
    """The propellers rotate at z=0.03, the feet end at z=-0.16."""
    shell, cream, black = material("Shell", SUN, 0.35), material("Cream", CREAM, 0.4), material("Black", NAVY, 0.5)
    steel, coral = material("Steel", STEEL, 0.35, 0.9), material("Coral", CORAL, 0.45)
    glass = material("Glass", "#0d161d", 0.1)
    eye = material("Eye", "#bff4ff", 0.3, glow=1.2)
    parts = [
        ellipsoid(0.10, 0.09, 0.05, squareness=0.35, columns=32, rows=16).moved(z=-0.03).painted(shell),
        lathe([(0, 0.0), (0.05, 0.0), (0.045, 0.018), (0.02, 0.03), (0, 0.032)], 28).moved(z=0.0).painted(cream),
        rounded_box(0.13, 0.08, 0.04, 0.015, 2).moved(-0.005, 0, -0.085).painted(black),
        rounded_box(0.07, 0.1, 0.04, 0.018, 2).moved(0.062, 0, -0.006).painted(glass),
        sphere(0.022, 16, 10).moved(0.06, 0, -0.105).painted(black),
        cylinder(0.012, 0.012, 0.003, 16).turned(y=90).moved(0.08, 0, -0.107).painted(glass),
    ]
    parts += mirrored([ellipsoid(0.004, 0.011, 0.014, columns=12, rows=6).moved(0.097, 0.027, -0.003).painted(eye)])
    for number, turn in enumerate((0, 90, 180, 270)):
        arm = [
            tube([(0.07, 0, -0.045), (REACH, 0, -0.012)], [0.013, 0.009], 10).painted(coral if number == 0 else cream)
        ]
        arm += [p.moved(REACH, 0, -0.012) for p in motor(0.018, 0.044, steel, black)]
        arm.append(blade(0.11, 0.026, 0.003, 90 + 25 * (number % 2)).moved(REACH, 0, 0.026).painted(black))
        leg = [(0.08, 0, -0.06), (0.13, 0, -0.10), (0.15, 0, -0.152)]
        arm.append(tube(leg, 0.006, 8).turned(z=45).painted(black))
        arm.append(box(0.03, 0.02, 0.008, 0.002).moved(0.15, 0, -0.157).turned(z=45).painted(coral))
        parts += [p.turned(z=turn) for p in arm]
    return parts
