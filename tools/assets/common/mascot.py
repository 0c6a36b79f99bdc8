"""Morsy, the mascot: a telegraphist with headphones, about 1.8 m tall and looking along +X."""

from __future__ import annotations

import numpy as np

from common.colors import CORAL, CREAM, NAVY, RUBBER, STEEL, SUN, TEAL
from common.materials import material
from common.morse_code import length, signs
from common.parts import Part, mirrored
from common.shapes import cylinder, ellipsoid, lathe, rounded_box, sphere, torus, tube


def morsy_parts() -> list[Part]:
    """The whole robot, standing on z=0 over the origin. The first material is the colour of its body."""
    body = material("Body", TEAL, 0.35)
    cream = material("Cream", CREAM, 0.4)
    coral = material("Coral", CORAL, 0.4)
    rubber = material("Rubber", RUBBER, 0.85)
    steel = material("Steel", STEEL, 0.3, 0.9)
    return [
        *_torso(body, cream, coral),
        *_wheels(rubber, coral, cream),
        *_arms(body, cream),
        *_head(cream, coral, steel, rubber),
    ]


def _torso(body, cream, coral) -> list[Part]:
    middle = 0.64
    radii = (0.335, 0.37, 0.44)
    parts = [
        ellipsoid(*radii, squareness=0.22, columns=36, rows=20).moved(z=middle).painted(body),
        lathe([(0, 0), (0.20, 0.0), (0.235, 0.03), (0.225, 0.07), (0, 0.07)], 32).moved(z=1.0).painted(cream),
    ]
    parts += _belt(radii, middle, 0.60, cream, coral)
    parts.append(rounded_box(0.13, 0.40, 0.44, 0.06, 2).moved(-0.32, 0, 0.74).painted(cream))  # battery on the back
    parts += mirrored([cylinder(0.035, 0.04, 0.01, 16).turned(y=-90).moved(-0.388, 0.1, 0.84).painted(coral)])
    return parts


def _belt(radii, middle, z, cream, coral) -> list[Part]:
    """A band around the belly that says MORSE."""
    swell = (abs((z - middle) / radii[2]) ** (2 / 0.824)) if z != middle else 0.0
    share = (1 - swell) ** (0.824 / 2)
    reach = [r * share + 0.006 for r in radii[:2]]

    def point(angle: float, height: float, lift: float) -> list[float]:
        c, s = np.cos(angle), np.sin(angle)
        p = 0.824
        return [(reach[0] + lift) * np.sign(c) * abs(c) ** p, (reach[1] + lift) * np.sign(s) * abs(s) ** p, z + height]

    columns = 64
    angles = np.arange(columns) * 2 * np.pi / columns
    profile = [(-0.075, -0.03), (-0.07, 0.004), (-0.06, 0.01), (0.06, 0.01), (0.07, 0.004), (0.075, -0.03)]
    vertices = np.array([point(a, h, lift) for h, lift in profile for a in angles])
    faces = [
        (i * columns + j, i * columns + (j + 1) % columns, (i + 1) * columns + (j + 1) % columns, (i + 1) * columns + j)
        for i in range(len(profile) - 1)
        for j in range(columns)
    ]
    parts = [Part(vertices, faces, cream)]
    unit = 0.034
    half = length("MORSE") / 2
    for sign, place in signs("MORSE"):
        # the front is viewed from outside, so that the text runs from the robot's right to its left
        ends = [place - half - 1.0, place - half + 1.0] if sign == "-" else [place - half - 0.02, place - half + 0.02]
        angles_of = np.linspace(ends[0], ends[1], 4 if sign == "-" else 2) * unit / 0.34
        parts.append(tube([point(a, 0.0, 0.012) for a in angles_of], 0.5 * unit, 8).painted(coral))
    return parts


def _wheels(rubber, coral, cream) -> list[Part]:
    radius, half = 0.27, 0.085
    tyre = lathe(
        [
            (0.15, -half),
            (0.20, -half),
            (0.245, -0.07),
            (radius, -0.03),
            (radius, 0.03),
            (0.245, 0.07),
            (0.20, half),
            (0.15, half),
        ],
        40,
    ).painted(rubber)
    rim = lathe(
        [
            (0.0, 0.07),
            (0.0, 0.07),
            (0.16, 0.07),
            (0.175, 0.078),
            (0.18, 0.088),
            (0.165, 0.096),
            (0.14, 0.09),
            (0.06, 0.085),
            (0.055, 0.11),
            (0.03, 0.118),
            (0, 0.12),
        ][1:],
        32,
    ).painted(cream)
    hub = [
        cylinder(0.022, 0.02, 0.005, 12).moved(0.105 * np.cos(a), 0.105 * np.sin(a), 0.094).painted(coral)
        for a in np.arange(5) * 2 * np.pi / 5
    ]
    left = [part.turned(x=-90).moved(y=0.44, z=radius) for part in (tyre, rim, *hub)]
    caster = sphere(0.09, 20, 10).moved(-0.24, 0, 0.09).painted(rubber)
    return [*mirrored(left), caster]


def _arms(body, cream) -> list[Part]:
    shoulder = sphere(0.085, 16, 8).moved(0.0, 0.37, 0.86).painted(cream)
    arm = tube(
        [(0.0, 0.40, 0.86), (0.03, 0.455, 0.80), (0.08, 0.475, 0.73), (0.14, 0.47, 0.68)],
        [0.06, 0.056, 0.052, 0.05],
        12,
    ).painted(body)
    hand = ellipsoid(0.085, 0.07, 0.075, columns=16, rows=10).moved(0.19, 0.46, 0.66).painted(cream)
    thumb = tube([(0.2, 0.42, 0.69), (0.235, 0.39, 0.72)], [0.032, 0.026], 10).painted(cream)
    return mirrored([shoulder, arm, hand, thumb])


def _head(cream, coral, steel, rubber) -> list[Part]:
    visor = material("Visor", NAVY, 0.12)
    eye = material("Eye", "#bff4ff", 0.3, glow=1.2)
    gleam = material("Gleam", "#ffffff", 0.3, glow=1.5)
    cheek = material("Cheek", "#ff9e8a", 0.5, glow=0.25)
    light = material("Lamp", SUN, 0.3, glow=1.5)
    z = 1.315
    parts = [
        rounded_box(0.62, 0.80, 0.56, 0.22, 4).moved(0.02, 0, z).painted(cream),
        rounded_box(0.20, 0.68, 0.44, 0.098, 3).moved(0.262, 0, z).painted(visor),
    ]
    face = 0.363  # x of the glass
    for side in (1, -1):
        parts += [
            ellipsoid(0.014, 0.075, 0.105, columns=20, rows=8).moved(face, side * 0.15, z + 0.035).painted(eye),
            ellipsoid(0.010, 0.022, 0.028, columns=12, rows=6)
            .moved(face + 0.008, side * 0.15 + 0.028, z + 0.085)
            .painted(gleam),
            ellipsoid(0.010, 0.042, 0.024, columns=12, rows=6)
            .moved(face - 0.002, side * 0.25, z - 0.105)
            .painted(cheek),
        ]
    smile = [(face + 0.001, 0.085 * np.sin(a), z - 0.085 - 0.055 * np.cos(a)) for a in np.linspace(-1.15, 1.15, 13)]
    parts.append(tube(smile, 0.0125, 8).painted(eye))
    # headphones of a telegraphist
    cup = (
        lathe(
            [(0, 0), (0.165, 0.0), (0.18, 0.02), (0.18, 0.05), (0.16, 0.075), (0.09, 0.085), (0.085, 0.095), (0, 0.1)],
            32,
        )
        .turned(x=-90)
        .moved(0.0, 0.42, z)
        .painted(coral)
    )
    pad = torus(0.145, 0.04, 28, 8).turned(x=90).moved(0.0, 0.405, z).painted(rubber)
    parts += mirrored([cup, pad])
    band = [(0.0, 0.47 * np.sin(a), z + 0.335 * np.cos(a)) for a in np.linspace(-1.45, 1.45, 19)]
    parts.append(tube(band, 0.028, 10).scaled(1.8, 1, 1).painted(coral))
    # aerial
    parts += [
        lathe([(0, 0), (0.05, 0), (0.045, 0.03), (0.018, 0.05), (0, 0.05)], 20).moved(z=z + 0.355).painted(steel),
        tube([(0, 0, z + 0.39), (0, 0, z + 0.455)], 0.009, 10).painted(steel),
        sphere(0.045, 20, 12).moved(z=z + 0.455).painted(light),
    ]
    return parts
