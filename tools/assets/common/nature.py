"""Trees, plants and rocks in a few hundred triangles each, standing on z=0."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from common.materials import material
from common.parts import Part
from common.shapes import ellipsoid, tube

if TYPE_CHECKING:
    from collections.abc import Sequence

    import bpy


@dataclass
class Greens:
    """Bark, and leaves from dark to light."""

    bark: bpy.types.Material
    leaves: tuple[bpy.types.Material, ...]

    @classmethod
    def make(cls) -> Greens:
        shades = (("Leaves Dark", "#3f7a3a"), ("Leaves", "#5b9a45"), ("Leaves Light", "#82b857"))
        return cls(material("Bark", "#6f4e37", 0.95), tuple(material(name, color, 0.9) for name, color in shades))


def blob(radius: float, seed: int, rough: float = 0.12, columns: int = 12, rows: int = 8) -> Part:
    """A lump with flat sides."""
    shape = ellipsoid(radius, radius, radius, columns=columns, rows=rows)
    random = np.random.default_rng(seed)
    return Part(
        shape.vertices * random.uniform(1 - rough, 1 + rough, (len(shape.vertices), 1)), shape.faces, smooth=False
    )


def broadleaf(greens: Greens, height: float, width: float, trunk: float, seed: int) -> list[Part]:
    """A tree with a round crown; ``trunk`` is the radius at the ground."""
    return [*trunk_of(greens, height, width, trunk, seed), *crown_of(greens, height, width, seed)]


def trunk_of(greens: Greens, height: float, width: float, trunk: float, seed: int) -> list[Part]:
    random = np.random.default_rng(seed)
    fork = height * 0.42
    sway = random.uniform(-0.03, 0.03, 2) * height
    stem = [(0, 0, 0), (sway[0] * 0.5, sway[1] * 0.5, fork * 0.6), (*sway, fork), (*sway, height * 0.72)]
    radii = [trunk * 1.25, trunk * 0.9, trunk * 0.75, trunk * 0.3]
    limbs = [(stem[k : k + 2], radii[k : k + 2], 9) for k in range(len(stem) - 1)]
    for k in range(4):
        angle = np.radians(90 * k + random.uniform(-25, 25))
        reach = width * random.uniform(0.22, 0.32)
        end = (sway[0] + reach * np.cos(angle), sway[1] + reach * np.sin(angle), height * random.uniform(0.56, 0.68))
        limbs.append(([(*sway, fork * (0.85 + 0.05 * k)), end], [trunk * 0.5, trunk * 0.2], 6))
    # each limb is convex, so that the collision shape equals the visible mesh
    return [tube(line, size, sides, round_ends=False).painted(greens.bark) for line, size, sides in limbs]


def crown_of(greens: Greens, height: float, width: float, seed: int) -> list[Part]:
    random = np.random.default_rng(seed + 100)
    size = width * 0.30
    parts = [blob(size * 1.25, seed).moved(0, 0, height * 0.70).painted(greens.leaves[1])]
    for k in range(7):
        angle, lift = np.radians(360 / 7 * k + random.uniform(-15, 15)), random.uniform(-0.10, 0.10)
        reach, radius = width * random.uniform(0.24, 0.31), size * random.uniform(0.62, 0.9)
        at = (reach * np.cos(angle), reach * np.sin(angle), height * (0.66 + lift))
        parts.append(blob(radius, seed + k + 1).moved(*at).painted(greens.leaves[k % 3]))
    parts.append(
        blob(size * 0.8, seed + 20).moved(width * 0.05, -width * 0.04, height * 0.87).painted(greens.leaves[2])
    )
    return parts


def hedge(leaves: Sequence[bpy.types.Material], length: float, width: float, height: float, seed: int) -> list[Part]:
    """A clipped hedge along X, its middle at the origin."""
    steps = max(round(length / 0.55), 2)
    outline = ((-0.5, -0.5), (-0.5, 0.05), (-0.36, 0.5), (0.36, 0.5), (0.5, 0.05), (0.5, -0.5))
    random = np.random.default_rng(seed)
    vertices = np.array(
        [(u * length, y * width, z * height) for u in np.linspace(-0.5, 0.5, steps + 1) for y, z in outline]
    )
    inner = np.repeat(np.arange(steps + 1) % steps > 0, len(outline))[:, None]
    vertices += random.uniform(-0.07, 0.07, vertices.shape) * inner * (1.0, 1.0, 1.4)
    sides = len(outline)
    faces = [
        (i * sides + j, i * sides + j + 1, (i + 1) * sides + j + 1, (i + 1) * sides + j)
        for i in range(steps)
        for j in range(sides - 1)
    ]
    shades = random.integers(0, len(leaves), len(faces))
    parts = [
        Part(vertices, [face for face, own in zip(faces, shades, strict=True) if own == shade], smooth=False).painted(
            paint
        )
        for shade, paint in enumerate(leaves)
    ]
    ends = [tuple(range(sides)), tuple(steps * sides + k for k in reversed(range(sides)))]
    return [*parts, Part(vertices, ends, smooth=False).painted(leaves[0])]


def blades(greens: Greens, radius: float, height: float, count: int, seed: int, width: float = 0.06) -> list[Part]:
    """A tuft: bent leaves that start in the middle."""
    random = np.random.default_rng(seed)
    parts = []
    for k in range(count):
        lean, tall, wide = (
            random.uniform(0.25, 1.0) * radius,
            height * random.uniform(0.6, 1.0),
            width * random.uniform(0.7, 1.2),
        )
        start, bend, tip = (0.02, 0.0), (lean * 0.45, tall * 0.75), (lean, tall * (1.0 - 0.35 * lean / radius))
        leaf = np.array(
            [
                (start[0], -wide / 3, start[1]),
                (start[0], wide / 3, start[1]),
                (bend[0], -wide / 2, bend[1]),
                (bend[0], wide / 2, bend[1]),
                (tip[0], 0, tip[1]),
            ]
        )
        part = Part(leaf, [(0, 2, 3, 1), (2, 4, 3)], smooth=False)
        spot = random.uniform(-0.15, 0.15, 2) * radius
        parts.append(part.turned(z=137.5 * k + random.uniform(-20, 20)).moved(*spot, 0).painted(greens.leaves[k % 3]))
    return parts


def fern(greens: Greens, radius: float, height: float, fronds: int, seed: int) -> list[Part]:
    """Long fronds with side leaves."""
    random = np.random.default_rng(seed)
    parts = []
    for k in range(fronds):
        reach = radius * random.uniform(0.75, 1.0)
        stations = np.linspace(0.05, 1.0, 9)
        line = np.column_stack(
            [reach * stations, np.zeros(9), height * random.uniform(0.75, 1.0) * np.sin(stations * 2.2)]
        )
        vertices, faces = [], []
        for i in range(8):
            a, b = line[i], line[i + 1]
            side = reach * 0.16 * (1.1 - stations[i])
            tip = (a + b) / 2 + (b - a) * 0.5
            n = len(vertices)
            vertices += [a, b, tip + np.array([0, side, -0.03]), tip + np.array([0, -side, -0.03])]
            faces += [(n, n + 1, n + 2), (n, n + 3, n + 1)]
        part = Part(np.array(vertices), faces, smooth=False)
        parts.append(part.turned(z=360 / fronds * k + random.uniform(-12, 12)).painted(greens.leaves[k % 3]))
    return parts


def rock(paint: bpy.types.Material, x: float, y: float, z: float, seed: int) -> Part:
    shape = blob(0.5, seed, 0.16, 10, 7)
    return shape.scaled(x, y, z).painted(paint)
