"""Boards, and wood textures."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from common.images import packed
from common.materials import material
from common.shapes import box
from common.textures import planks, wood

if TYPE_CHECKING:
    import bpy

    from common.parts import Part


def wooden(name: str, dark: str, light: str, seed: int, roughness: float = 0.75, size: int = 256) -> bpy.types.Material:
    """A material with wood grain."""
    picture = packed(f"{name.lower().replace(' ', '_')}.jpg", wood(size, dark, light, seed))
    return material(name, light, roughness, image=picture)


def planked(
    name: str, dark: str, light: str, seed: int, boards: int = 4, roughness: float = 0.75
) -> bpy.types.Material:
    """A material with boards side by side, the grain along u."""
    picture = packed(f"{name.lower().replace(' ', '_')}.jpg", planks(512, dark, light, boards, seed))
    return material(name, light, roughness, image=picture)


class Carpenter:
    """Cuts boards, each with another piece of the same texture."""

    def __init__(self, seed: int, metres: float = 0.7):
        self._random = np.random.default_rng(seed)
        self._metres = metres

    def board(self, x: float, y: float, z: float, material: bpy.types.Material, chamfer: float = 0.006) -> Part:
        """A box with the grain along its longest side."""
        return self.cut(box(x, y, z, min(chamfer, 0.4 * min(x, y, z))), material)

    def cut(self, shape: Part, material: bpy.types.Material) -> Part:
        """A shape with the grain along its longest side."""
        extent = np.ptp(shape.vertices, axis=0)
        offset = self._random.uniform(0.0, 1.0, 2)
        return shape.mapped(self._metres, grain=int(np.argmax(extent)), offset=offset).painted(material)
