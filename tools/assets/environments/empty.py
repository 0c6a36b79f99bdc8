"""A very large laboratory floor: a grid of 1 m for judging distances, and no objects."""

from __future__ import annotations

import numpy as np
from common.images import packed
from common.materials import material
from common.objects import exact
from common.shapes import box
from common.sky import sky, sunshine
from common.textures import lines, speckle

TILE = 4.0  # metres that one texture covers


def build() -> None:
    sky("#bcd3e6")
    sunshine()
    floor = material("Floor", "#a4adb2", 0.7, image=packed("floor_grid.png", floor_picture(512)))
    slab = box(40, 40, 0.1305).mapped(TILE, offset=(0.5, 0.5)).painted(floor)
    exact("Ground", [slab], (40, 40, 0.1305), (0, 0, 0), (0, 0, -0.0653), physics_type="STATIC")


def floor_picture(size: int) -> np.ndarray:
    """Pale tiles of 1 m; a stronger line every 4 m."""
    tiles = speckle(size, "#9ea8ae", "#a9b2b7", seed=1, coarse=20.0)
    fine, strong = (lines(size, count, width)[..., None] for count, width in ((4, 0.022), (1, 0.012)))
    tiles = tiles * (1 - 0.16 * fine) * (1 - 0.30 * strong)
    return np.round(tiles * 64) / 64
