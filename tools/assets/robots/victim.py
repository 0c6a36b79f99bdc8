"""A person who needs help and waves with both arms."""

from __future__ import annotations

from common.colors import CORAL, SKY, WHITE
from common.materials import material
from common.objects import exact
from common.parts import Part, mirrored
from common.shapes import ellipsoid, lathe, rounded_box, sphere, tube


def build() -> None:
    exact(
        "Victim",
        person(),
        (0.318, 1.72, 1.82),
        (-0.018, 0, 0.908),
        physics_type="DYNAMIC",
        collision="convex",
        mass=1.0,
    )


def person() -> list[Part]:
    """Standing on z=0, facing +X, arms spread to +-0.86."""
    skin, shirt, jeans = (
        material("Skin", "#e0a47e", 0.6),
        material("Shirt", CORAL, 0.8),
        material("Trousers", "#33517a", 0.85),
    )
    shoe, hair, dark = (
        material("Shoes", "#3a2d26", 0.7),
        material("Hair", "#4b2e1e", 0.8),
        material("Dark", "#20252b", 0.4),
    )
    bandage, cross = material("Bandage", WHITE, 0.9), material("Sign", "#d8262c", 0.6)
    blue = material("Sleeve", SKY, 0.8)
    leg = [
        tube([(0, 0.10, 0.86), (0.0, 0.105, 0.5), (-0.01, 0.11, 0.12)], [0.105, 0.085, 0.07], 16).painted(jeans),
        rounded_box(0.27, 0.12, 0.10, 0.045, 3).moved(0.045, 0.112, 0.05).painted(shoe),
    ]
    arm = [
        tube([(0, 0.19, 1.36), (0, 0.34, 1.34), (0.0, 0.46, 1.33)], [0.085, 0.075, 0.066], 14).painted(blue),
        tube([(0.0, 0.44, 1.33), (0.01, 0.60, 1.40), (0.02, 0.74, 1.50)], [0.052, 0.048, 0.042], 12).painted(skin),
        ellipsoid(0.038, 0.055, 0.085, columns=14, rows=8).turned(x=-32).moved(0.025, 0.795, 1.56).painted(skin),
        tube([(0.03, 0.76, 1.56), (0.04, 0.735, 1.61)], [0.018, 0.015], 8).painted(skin),
    ]
    parts = mirrored([*leg, *arm])
    parts += [
        ellipsoid(0.135, 0.21, 0.32, squareness=0.25, columns=28, rows=18).moved(z=1.12).painted(shirt),
        ellipsoid(0.13, 0.185, 0.12, squareness=0.3, columns=24, rows=12).moved(z=0.87).painted(jeans),
        tube([(0, 0, 1.36), (0.005, 0, 1.48)], 0.055, 14).painted(skin),
        ellipsoid(0.115, 0.105, 0.145, squareness=0.1, columns=28, rows=18).moved(0.01, 0, 1.63).painted(skin),
        ellipsoid(0.122, 0.116, 0.10, columns=24, rows=12).moved(-0.018, 0, 1.715).painted(hair),
        lathe([(0.112, -0.022), (0.121, -0.018), (0.121, 0.018), (0.112, 0.022)], 28)
        .scaled(1.02, 0.98, 1)
        .turned(x=10)
        .moved(0.0, 0, 1.70)
        .painted(bandage),
        sphere(0.018, 10, 8).moved(0.125, 0, 1.61).painted(skin),
        ellipsoid(0.012, 0.022, 0.026, columns=14, rows=8).moved(0.108, 0, 1.553).painted(dark),  # calls for help
    ]
    parts += mirrored(
        [
            sphere(0.014, 10, 8).moved(0.113, 0.042, 1.645).painted(dark),
            sphere(0.026, 10, 8).scaled(0.6, 0.6, 1).moved(0.0, 0.108, 1.625).painted(skin),
        ]
    )
    parts += [
        rounded_box(0.02 + 0.002 * k, *size, 0.008, 1).moved(0.132, 0, 1.2).painted(cross)
        for k, size in enumerate(((0.13, 0.04), (0.04, 0.13)))
    ]
    return parts
