"""A small town of plain houses."""

from __future__ import annotations

from dataclasses import dataclass

import bpy
import numpy as np

from common.colors import srgb
from common.images import packed
from common.materials import material
from common.parts import Part
from common.shapes import box
from common.textures import speckle

STOREY = 3.0  # metres: width and height that one texture with one window covers
FACADES = (
    ("Facade Cream", "#efe3c6"),
    ("Facade Rose", "#e0a08c"),
    ("Facade Blue", "#9fbdd0"),
    ("Facade Sand", "#dcc08a"),
)


@dataclass
class Masonry:
    facades: list[bpy.types.Material]
    roof: bpy.types.Material
    chimney: bpy.types.Material

    @classmethod
    def make(cls) -> Masonry:
        """The materials, shared by all houses of a file."""
        made = bpy.data.materials
        facades = [
            made.get(name)
            or material(name, color, 0.9, image=packed(f"{name.lower().replace(' ', '_')}.png", facade(color)))
            for name, color in FACADES
        ]
        roof = made.get("Roof") or material("Roof", "#a5503a", 0.85)
        return cls(facades, roof, made.get("Chimney") or material("Chimney", "#6d5a52", 0.9))


def facade(color: str, size: int = 128) -> np.ndarray:
    """A wall with one window."""
    picture = speckle(size, color, color, 3) * 0.0 + srgb(color)
    picture = picture * (1 + 0.03 * np.sin(np.arange(size) * 0.8))[:, None, None]
    top, bottom, left, right = (int(size * f) for f in (0.25, 0.72, 0.30, 0.70))
    picture[top - 4 : bottom + 6, left - 4 : right + 4] = srgb("#fbf8ef")
    sky = np.linspace(0.0, 1.0, bottom - top)[:, None, None]
    picture[top:bottom, left:right] = srgb("#5d7f96") * (1 - sky) + srgb("#35505f") * sky
    middle = (left + right) // 2
    picture[top:bottom, middle - 1 : middle + 2] = picture[
        (top + bottom) // 2 - 1 : (top + bottom) // 2 + 2, left:right
    ] = srgb("#fbf8ef")
    picture[bottom + 2 : bottom + 7, left - 8 : right + 8] = srgb("#c9bfa8")
    return np.round(picture * 40) / 40


def house(masonry: Masonry, x: float, y: float, storeys: int, look: int) -> list[Part]:
    """A house of about x times y metres on z=0 with a gable roof along its longer side."""
    x, y = (max(round(v / STOREY), 2) * STOREY for v in (x, y))
    height = storeys * STOREY
    walls = wall_box(x, y, height).painted(masonry.facades[look % len(masonry.facades)])
    along = x >= y
    span, run = (y, x) if along else (x, y)
    rise, eave = span * 0.30, 0.5
    ridge = [(-run / 2 - eave, 0, rise), (run / 2 + eave, 0, rise)]
    foot = -eave * rise / (span / 2)
    low = [(s * (run / 2 + eave), t * (span / 2 + eave), foot) for t in (-1, 1) for s in (-1, 1)]
    vertices = np.array([*ridge, *low])
    roof = Part(vertices, [(2, 3, 1, 0), (5, 4, 0, 1), (4, 2, 0), (3, 5, 1), (2, 4, 5, 3)], masonry.roof, smooth=False)
    chimney = box(0.7, 0.7, 1.6).moved(run * 0.25, span * 0.18, rise * 0.85).painted(masonry.chimney)
    top = [p if along else p.turned(z=90) for p in (roof, chimney)]
    return [walls, *(p.moved(z=height) for p in top)]


def wall_box(x: float, y: float, height: float) -> Part:
    """A box on z=0 whose textures start at the corners of each wall."""
    part = box(x, y, height).moved(z=height / 2)
    uvs = []
    for face in part.faces:
        corners = part.vertices[list(face)]
        extent = np.ptp(corners, axis=0)
        along = 0 if extent[0] > 1e-6 else 1
        uv = np.column_stack([corners[:, along] - corners[:, along].min(), corners[:, 2]])
        uvs.append(np.zeros_like(uv) if extent[2] < 1e-6 else uv / STOREY)
    return Part(part.vertices, part.faces, uvs=uvs, smooth=False)


def tower(masonry: Masonry, x: float, y: float, storeys: int, look: int) -> list[Part]:
    """A tall house with a flat roof."""
    x, y = (max(round(v / STOREY), 2) * STOREY for v in (x, y))
    height = storeys * STOREY
    return [
        wall_box(x, y, height).painted(masonry.facades[look % len(masonry.facades)]),
        box(x + 0.4, y + 0.4, 0.5).moved(z=height + 0.25).painted(masonry.chimney),
        box(x * 0.3, y * 0.3, 1.6).moved(x * 0.15, 0, height + 1.1).painted(masonry.chimney),
    ]


def quarter(masonry: Masonry, x: float, y: float, height: float, seed: int) -> list[Part]:
    """Houses on all plots of x times y metres, with a maximum height of about ``height``."""
    random = np.random.default_rng(seed)
    columns, rows = max(round(x / 15.0), 1), max(round(y / 15.0), 1)
    plot_x, plot_y = x / columns, y / rows
    most = max(int((height - 2.1) / STOREY), 1)
    parts = []
    for number, (i, j) in enumerate((i, j) for i in range(columns) for j in range(rows)):
        wide, deep = max(plot_x - 4.0, 6.0), max(plot_y - 4.0, 6.0)
        at = ((i + 0.5) * plot_x - x / 2, (j + 0.5) * plot_y - y / 2)
        storeys = most if number == 0 else int(random.integers(max(most // 2, 1), most + 1))
        build = tower if storeys > 3 else house
        made = build(masonry, wide, deep, storeys, number + seed)
        parts += [p.moved(*at) for p in made]
    return parts
