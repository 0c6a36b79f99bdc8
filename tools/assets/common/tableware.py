"""Objects for a kitchen table, centred on the origin, in about their usual size; objects are scaled to their own."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from common.colors import srgb
from common.images import packed
from common.lettering import write_centred
from common.materials import material
from common.parts import Part
from common.shapes import box, cylinder, lathe, prism, rounded_box, tube

if TYPE_CHECKING:
    import bpy

    from common.stock import Stock


def plate(stock: Stock, deep: float) -> list[Part]:
    """A dish of radius 1; ``deep`` is its height."""
    profile = [
        (0, 0),
        (0.55, 0.0),
        (0.6, deep * 0.2),
        (0.95, deep * 0.92),
        (1.0, deep),
        (0.93, deep),
        (0.58, deep * 0.38),
        (0.5, deep * 0.22),
        (0, deep * 0.2),
    ]
    return [
        lathe(profile, 36).painted(stock["white"]),
        lathe([(0.955, deep * 0.99), (0.985, deep * 1.01), (0.955, deep * 1.03)], 36).painted(stock["teal"]),
    ]


def bowl(stock: Stock, paint: str) -> list[Part]:
    profile = [
        (0, 0),
        (0.4, 0.0),
        (0.45, 0.04),
        (0.8, 0.25),
        (0.98, 0.62),
        (1.0, 0.67),
        (0.94, 0.67),
        (0.75, 0.32),
        (0.42, 0.1),
        (0, 0.08),
    ]
    return [lathe(profile, 32).painted(stock[paint])]


def cup(paint: bpy.types.Material) -> list[Part]:
    """Its handle is towards +Y."""
    body = [(0, -0.5), (0.36, -0.5), (0.42, -0.46), (0.46, 0.5), (0.42, 0.5), (0.38, -0.4), (0, -0.42)]
    handle = [(0, 0.44, 0.3), (0, 0.66, 0.32), (0, 0.78, 0.1), (0, 0.70, -0.2), (0, 0.43, -0.28)]
    return [lathe(body, 32).painted(paint), tube(handle, 0.055, 10).painted(paint)]


def fork(stock: Stock) -> list[Part]:
    tines = [rounded_box(0.07, 0.5, 0.03, 0.014, 1).moved(x, 0.75, 0.02) for x in (-0.15, -0.05, 0.05, 0.15)]
    return [
        p.painted(stock["steel"])
        for p in (handle(), *tines, rounded_box(0.38, 0.22, 0.05, 0.02, 1).moved(0, 0.45, 0.0))
    ]


def spoon(stock: Stock) -> list[Part]:
    hollow = lathe([(0, -0.09), (0.14, -0.06), (0.25, 0.03), (0.23, 0.04), (0.12, -0.03), (0, -0.05)], 24).scaled(
        1, 1.5, 1
    )
    return [p.painted(stock["steel"]) for p in (handle(), hollow.moved(0, 0.62, 0.02))]


def knife(stock: Stock) -> list[Part]:
    edge = prism([(-0.1, -0.05), (0.06, -0.05), (0.14, 0.2), (0.12, 0.7), (0.0, 1.0), (-0.1, 1.0)], 0.04).moved(z=-0.02)
    return [edge.painted(stock["steel"]), handle().painted(stock["black"])]


def handle() -> Part:
    return rounded_box(0.16, 1.2, 0.07, 0.03, 2).moved(0, -0.35, 0)


def spatula(stock: Stock) -> list[Part]:
    slots = [rounded_box(0.1, 0.5, 0.03, 0.014, 1).moved(x, 0.85, 0) for x in (-0.26, -0.09, 0.09, 0.26)]
    head = [
        *slots,
        rounded_box(0.66, 0.12, 0.03, 0.014, 1).moved(0, 1.12, 0),
        rounded_box(0.66, 0.12, 0.03, 0.014, 1).moved(0, 0.58, 0),
    ]
    stick = tube([(0, -1.2, 0.06), (0, 0.1, 0.04), (0, 0.58, 0)], [0.09, 0.05, 0.04], 10)
    return [*(p.painted(stock["black"]) for p in head), stick.painted(stock["coral"])]


def packet(x: float, y: float, z: float, name: str, color: str, accent: str) -> list[Part]:
    """A carton with a word on its broad sides, which face along the shorter of X and Y."""
    picture = np.broadcast_to(srgb(color), (128, 96, 3)).copy()
    picture[70:128] = srgb(accent)
    yy, xx = np.mgrid[0:128, 0:96]
    picture[(yy - 78) ** 2 + (xx - 48) ** 2 < 26**2] = srgb("#fff6df")
    write_centred(picture, name, 18, srgb("#ffffff"), 2)
    paint = material(name.title(), color, 0.7, image=packed(f"{name.lower()}.png", picture))
    part = box(x, y, z)
    along = 1 if x < y else 0
    mapped = part.stretched_over((along, 2))
    uvs = [
        mirrored_where_needed(part.vertices[list(f)], uv, along)
        for f, uv in zip(part.faces, mapped.uvs or [], strict=True)
    ]
    return [Part(part.vertices, part.faces, paint, uvs, smooth=False)]


def mirrored_where_needed(corners: np.ndarray, uv: np.ndarray, along: int) -> np.ndarray:
    """Words that read from left to right on both broad sides."""
    across = 1 - along
    outwards = corners[:, across].mean()
    flip = outwards > 1e-9 if along == 0 else outwards < -1e-9
    return np.column_stack([1 - uv[:, 0], uv[:, 1]]) if flip else uv


def jar(stock: Stock, content: str, lid: str) -> list[Part]:
    glass = [(0, 0), (0.42, 0.0), (0.5, 0.08), (0.5, 0.72), (0.44, 0.8), (0, 0.8)]
    return [
        lathe(glass, 28).painted(stock[content]),
        lathe([(0, 0.78), (0.47, 0.78), (0.47, 0.98), (0.44, 1.0), (0, 1.0)], 28).painted(stock[lid]),
        lathe([(0.5, 0.2), (0.508, 0.21), (0.508, 0.62), (0.5, 0.63)], 28).painted(stock["paper"]),
    ]


def bread(stock: Stock, crust: bpy.types.Material) -> list[Part]:
    loaf = rounded_box(0.33, 0.18, 0.08, 0.039, 3).moved(z=0.04).painted(crust)
    return [
        loaf,
        *(
            rounded_box(0.012, 0.11, 0.01, 0.004, 1).turned(z=25).moved(x, 0, 0.078).painted(stock["cream"])
            for x in (-0.09, -0.03, 0.03, 0.09)
        ),
    ]


def butter_dish(stock: Stock) -> list[Part]:
    return [
        rounded_box(0.13, 0.18, 0.012, 0.005, 2).moved(z=0.006).painted(stock["white"]),
        rounded_box(0.06, 0.1, 0.03, 0.006, 2).moved(z=0.024).painted(stock["sun"]),
    ]


def cooker(stock: Stock) -> list[Part]:
    """A hot plate, with its switch at +X."""
    return [
        rounded_box(0.28, 0.28, 0.06, 0.015, 2).painted(stock["white"]),
        cylinder(0.095, 0.02, 0.004, 36).moved(z=0.036).painted(stock["black"]),
        *(
            cylinder(0.012, 0.014, 0.003, 12).moved(x, y, -0.036).painted(stock["black"])
            for x in (-0.11, 0.11)
            for y in (-0.11, 0.11)
        ),
        cylinder(0.025, 0.03, 0.005, 20).turned(y=90).moved(0.15, 0, 0.0).painted(stock["coral"]),
    ]


def cloth(stock: Stock, x: float, y: float, paint: str, border: str) -> list[Part]:
    return [box(x, y, 0.6).painted(stock[border]), box(x * 0.9, y * 0.93, 0.4).moved(z=0.3).painted(stock[paint])]
