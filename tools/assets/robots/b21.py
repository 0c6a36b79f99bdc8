"""A tall round robot for museums and corridors."""

from __future__ import annotations

import numpy as np
from common.colors import CREAM, NAVY, STEEL, TEAL
from common.materials import material
from common.objects import empty, exact, hidden_cylinder
from common.parts import Part
from common.shapes import box, cylinder, lathe, rounded_box, sphere


def build() -> None:
    shell, cream, black = (
        material("Shell", "#a93243", 0.35),
        material("Cream", CREAM, 0.4),
        material("Black", NAVY, 0.4),
    )
    steel, glass = material("Steel", STEEL, 0.3, 0.9), material("Glass", "#0d161d", 0.1)
    root = empty("b21", physics_type="DYNAMIC", collision="convex", compound=1, mass=6.0)
    body = hidden_cylinder("b21_collision", 0.267, 0.94, (0, 0, 0.47), parent=root, physics_type="RIGID_BODY", mass=1.0)
    for name, parts, size, centre, z in (
        ("b21_base", base(shell, black, steel), (0.523, 0.522, 0.279), (0, 0, 0.14), 0.003),
        ("b21_mid", [cylinder(0.2255, 0.1, 0.01, 48).painted(black)], (0.451, 0.451, 0.1), (0, 0, 0), 0.323),
        ("b21_top", top(shell, cream, black, steel, glass), (0.492, 0.492, 0.57), (0, 0, 0), 0.655),
    ):
        exact(name, parts, size, centre, (0, 0, z), parent=body, physics_type="NO_COLLISION")


def base(shell, black, steel) -> list[Part]:
    skirt = [
        (0, 0.03),
        (0.225, 0.03),
        (0.225, 0.05),
        (0.261, 0.06),
        (0.261, 0.22),
        (0.25, 0.245),
        (0.21, 0.279),
        (0, 0.279),
    ]
    parts = [
        lathe(skirt, 48).painted(shell),
        lathe([(0, 0.1), (0.2625, 0.1), (0.2625, 0.125), (0, 0.125)], 48).painted(black),
    ]
    wheel = cylinder(0.055, 0.045, 0.008, 24).turned(x=90).moved(0.17, 0, 0.055).painted(black)
    parts += [wheel.turned(z=angle) for angle in (45, 135, 225, 315)]
    return parts + ring_of(12, 0.25, 0.185, 0.013, steel)


def top(shell, cream, black, steel, glass) -> list[Part]:
    wall = [
        (0, -0.285),
        (0.235, -0.285),
        (0.246, -0.27),
        (0.246, 0.16),
        (0.235, 0.175),
        (0.235, 0.205),
        (0.242, 0.212),
        (0.242, 0.235),
    ]
    cap = [(0, 0.235), (0.242, 0.235), (0.215, 0.262), (0.14, 0.276), (0, 0.28)]
    parts = [lathe([*wall, (0, 0.235)], 48).painted(shell), lathe(cap, 48).painted(cream)]
    parts += [lathe([(0, 0.176), (0.2375, 0.176), (0.2375, 0.204), (0, 0.204)], 48).painted(black)]
    parts += ring_of(24, 0.2365, 0.19, 0.0125, steel)
    parts += [
        door(0.2475, 38, 0.32).moved(z=-0.09).turned(z=angle).painted(cream) for angle in (60, 120, 180, 240, 300)
    ]
    # the face: a dark pane with two eyes, and a grille for the voice
    parts.append(rounded_box(0.05, 0.24, 0.12, 0.024, 3).moved(0.222, 0, 0.07).painted(glass))
    eye = material("Eye", "#bff4ff", 0.3, glow=1.2)
    for side in (1, -1):
        parts.append(sphere(0.022, 16, 10).scaled(0.4, 0.8, 1.1).moved(0.245, side * 0.05, 0.075).painted(eye))
    for z in np.linspace(-0.05, -0.15, 5):
        parts.append(box(0.008, 0.11, 0.008, 0.002).moved(0.243, 0, z).painted(black))
    parts.append(cylinder(0.03, 0.014, 0.004, 20).moved(-0.1, 0.0, 0.277).painted(material("Stop", "#e1261c", 0.4)))
    parts.append(rounded_box(0.1, 0.14, 0.016, 0.007, 1).moved(0.06, 0, 0.276).painted(material("Panel", TEAL, 0.4)))
    return parts


def door(radius: float, degrees: float, height: float) -> Part:
    """A piece of the wall of a cylinder, centred on the X axis."""
    angles = np.radians(np.linspace(-degrees / 2, degrees / 2, 9))
    arc = np.column_stack([radius * np.cos(angles), radius * np.sin(angles)])
    low, high = (np.column_stack([arc, np.full(len(arc), z)]) for z in (-height / 2, height / 2))
    count = len(arc)
    return Part(np.concatenate([low, high]), [(i, i + 1, count + i + 1, count + i) for i in range(count - 1)])


def ring_of(count: int, radius: float, z: float, size: float, paint) -> list[Part]:
    """Range finders around the body."""
    eye = cylinder(size, 0.01, 0.002, 14).turned(y=90).moved(radius, 0, z).painted(paint)
    return [eye.turned(z=360 * (k + 0.5) / count) for k in range(count)]
