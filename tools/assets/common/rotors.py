"""Propellers and motors, rotating about Z."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from common.parts import Part
from common.shapes import cylinder, lathe

if TYPE_CHECKING:
    import bpy


def blade(radius: float, width: float, thickness: float, turn: float = 0.0) -> Part:
    """Two blades with rounded tips in one piece."""
    span = np.linspace(-1.0, 1.0, 17)
    chord = width / 2 * np.sqrt(np.clip(1 - np.abs(span) ** 5, 0.0, 1.0)) * (0.55 + 0.45 * np.abs(span))
    chord = np.maximum(chord, width * 0.06)
    edges = [np.column_stack([span * radius, side * chord, np.full(17, z)]) for z in (-0.5, 0.5) for side in (-1, 1)]
    vertices = np.concatenate(edges) * np.array([1.0, 1.0, thickness])
    faces: list[tuple[int, ...]] = []
    for i in range(16):
        faces += [
            (i, 17 + i, 18 + i, 1 + i),  # below
            (34 + i, 35 + i, 52 + i, 51 + i),  # above
            (i, 1 + i, 35 + i, 34 + i),  # front
            (17 + i, 51 + i, 52 + i, 18 + i),  # back
        ]
    faces += [(0, 34, 51, 17), (16, 33, 67, 50)]
    return Part(vertices, faces, smooth=False).turned(z=turn)


def motor(radius: float, height: float, metal: bpy.types.Material, cap: bpy.types.Material) -> list[Part]:
    """A motor that stands on z=0."""
    dome = [(0, height * 0.8), (radius * 0.6, height * 0.8), (radius * 0.4, height * 0.95), (0, height)]
    return [
        cylinder(radius, height * 0.6, radius * 0.15, 20).moved(z=height * 0.3).painted(metal),
        cylinder(radius * 0.85, height * 0.25, radius * 0.1, 20).moved(z=height * 0.7).painted(cap),
        lathe(dome, 20).painted(metal),
    ]
