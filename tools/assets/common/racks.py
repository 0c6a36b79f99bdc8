"""Pallet racks: posts, beams and shelves, with cartons on pallets; all parts are boxes.

A rack runs along X and is open towards -Y; it stands on z=0, its middle over the origin.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from common.colors import srgb
from common.images import packed
from common.materials import material
from common.shapes import box
from common.textures import speckle
from common.wood import wooden

if TYPE_CHECKING:
    import bpy

    from common.parts import Part

#: depth of a rack, height of its posts and of its shelves
DEPTH, POSTS, LEVELS = 1.05, 4.6, (0.0, 1.7, 3.3)
PALLET = (1.2, 0.8, 0.144)


@dataclass
class Goods:
    """The materials of racks and their contents."""

    post: bpy.types.Material
    beam: bpy.types.Material
    deck: bpy.types.Material
    wood: bpy.types.Material
    cartons: tuple[bpy.types.Material, ...]

    @classmethod
    def make(cls) -> Goods:
        shades = (
            ("#b98a57", "#c99d6b", "#a5763f"),
            ("#a97c4c", "#bb8f5e", "#95693a"),
            ("#e4dfd3", "#f0ece2", "#5aa9e6"),
        )
        cartons = tuple(
            material(f"Carton {k}", light, 0.9, image=packed(f"carton_{k}.jpg", carton(256, dark, light, tape, 41 + k)))
            for k, (dark, light, tape) in enumerate(shades)
        )
        totes = tuple(
            material(f"Tote {name}", color, 0.6) for name, color in (("Teal", "#1f8a8c"), ("Coral", "#d9694c"))
        )
        return cls(
            post=material("Rack Post", "#2f6690", 0.5, 0.3),
            beam=material("Rack Beam", "#e8833a", 0.5, 0.2),
            deck=material("Rack Deck", "#b9bfc3", 0.6, 0.3),
            wood=wooden("Pallet Wood", "#a9773f", "#d3a468", 45),
            cartons=(*cartons, *totes),
        )


def carton(size: int, low: str, high: str, tape: str, seed: int) -> np.ndarray:
    """One side of a carton: board with a strip of tape across and a label."""
    picture = speckle(size, low, high, seed)
    across = slice(int(size * 0.44), int(size * 0.56))
    picture[:, across] = 0.35 * picture[:, across] + 0.65 * srgb(tape)
    edge = int(size * 0.012)
    for border in (np.s_[:edge], np.s_[-edge:], np.s_[:, :edge], np.s_[:, -edge:]):
        picture[border] *= 0.8
    label = np.s_[int(size * 0.62) : int(size * 0.84), int(size * 0.66) : int(size * 0.92)]
    picture[label] = srgb("#f7f6f1")
    bars = np.random.default_rng(seed).random(int(size * 0.92) - int(size * 0.66)) < 0.5
    lower = np.s_[int(size * 0.74) : int(size * 0.81), int(size * 0.66) : int(size * 0.92)]
    picture[lower] = np.where(bars[None, :, None], srgb("#26292d"), picture[lower])
    return picture


def rack(goods: Goods, bays: int, bay: float, seed: int) -> list[Part]:
    """A row of bays, each with space for two pallets on each level."""
    random, length = np.random.default_rng(seed), bays * bay
    parts = []
    for x in np.linspace(-length / 2, length / 2, bays + 1):
        parts += [box(0.09, 0.09, POSTS).moved(x, y, POSTS / 2).painted(goods.post) for y in (-0.48, 0.48)]
        parts += [box(0.04, 0.87, 0.06).moved(x, 0, z).painted(goods.post) for z in (0.4, 2.4, 4.2)]
    for level in LEVELS[1:]:
        beam = box(length - 0.09, 0.05, 0.12)
        parts += [beam.moved(0, y, level - 0.06).painted(goods.beam) for y in (-0.5, 0.5)]
        parts.append(box(length - 0.1, 0.93, 0.04).moved(0, 0, level - 0.02).painted(goods.deck))
    for column in range(2 * bays):
        x = (column + 0.5) * bay / 2 - length / 2 + (0.03 if column % 2 else -0.03)
        for k, level in enumerate(LEVELS):
            if random.random() < (0.92, 0.85, 0.7)[k]:
                parts += [part.moved(x, 0, level) for part in pallet(goods)]
                parts += [part.moved(x, 0, level + PALLET[2]) for part in load(goods, random, 1.25)]
    return parts


def pallet(goods: Goods) -> list[Part]:
    """Three runners under a deck."""
    long_, wide, high = PALLET
    deck = box(long_, wide, 0.044).moved(z=high - 0.022)
    runners = [box(long_, 0.1, high - 0.044).moved(0, y, (high - 0.044) / 2) for y in (-0.35, 0.0, 0.35)]
    return [part.mapped(0.7, grain=0).painted(goods.wood) for part in (deck, *runners)]


def load(goods: Goods, random: np.random.Generator, most: float) -> list[Part]:
    """Cartons or totes on a pallet, up to a maximum height, m."""
    paint = goods.cartons[int(random.choice(5, p=(0.36, 0.26, 0.14, 0.12, 0.12)))]
    along, layers = int(random.integers(1, 3)), int(random.integers(1, 4))
    high, size = most * random.uniform(0.75, 1.0) / 3, 1.1 / along
    parts = []
    for layer in range(layers):
        for k in range(along if layer < layers - 1 or random.random() < 0.6 else 1):
            side = box(size - 0.015, 0.76, high - 0.006).moved((k + 0.5) * size - 0.55, 0, (layer + 0.5) * high)
            parts.append(side.painted(paint) if "Tote" in paint.name else whole(side).painted(paint))
    return parts


def whole(shape: Part) -> Part:
    """The texture of a carton fills each of its faces."""
    uvs = []
    for face in shape.faces:
        points = shape.vertices[list(face)]
        flat = [axis for axis in range(3) if np.ptp(points[:, axis]) > 1e-9]
        low, extent = points[:, flat].min(axis=0), np.ptp(points[:, flat], axis=0)
        uvs.append((points[:, flat] - low) / extent)
    return replace(shape, uvs=uvs)
