"""Wheels that rotate about Z, with their outer side towards +Z."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from common.shapes import box, cylinder, lathe, torus

if TYPE_CHECKING:
    import bpy

    from common.parts import Part


def tyre(radius: float, width: float, bore: float, rubber: bpy.types.Material, columns: int = 36) -> list[Part]:
    """A smooth tyre around a hole of radius ``bore``."""
    half, shoulder = width / 2, min(width * 0.3, (radius - bore) * 0.5)
    profile = [
        (bore, -half),
        (radius - shoulder, -half),
        (radius - 0.3 * shoulder, -half + 0.3 * shoulder),
        (radius, -half + shoulder),
    ]
    profile += [(r, -h) for r, h in reversed(profile)]
    return [lathe(profile, columns).painted(rubber)]


def tread_tyre(radius: float, width: float, bore: float, rubber: bpy.types.Material, lugs: int = 20) -> list[Part]:
    """A tyre for rough ground."""
    depth = radius * 0.07
    parts = tyre(radius - depth, width * 0.96, bore, rubber, 32)
    for number in range(lugs):
        for side in (1, -1):
            lug = box(depth * 2.4, radius * 0.17, width * 0.46, radius * 0.02).turned(x=side * 18)
            angle = 360 / lugs * (number + (0.5 if side < 0 else 0.0))
            parts.append(lug.moved(radius - depth * 1.2, 0, side * width * 0.25).turned(z=angle).painted(rubber))
    return parts


def dish(radius: float, width: float, metal: bpy.types.Material, cap: bpy.types.Material, bolts: int = 5) -> list[Part]:
    """A closed rim for the hole of a tyre: bowl, lip, hub cap and bolts."""
    half = width / 2
    bowl = [
        (0, -half * 0.9),
        (radius * 1.02, -half * 0.9),
        (radius * 1.02, half),
        (radius * 0.9, half * 1.02),
        (radius * 0.82, half * 0.6),
        (radius * 0.35, half * 0.5),
    ]
    parts = [lathe([*bowl, (0, half * 0.5)], 32).painted(metal)]
    hub = [(0, 0), (radius * 0.34, 0.0), (radius * 0.3, half * 0.45), (radius * 0.2, half * 0.55), (0, half * 0.58)]
    parts.append(lathe(hub, 24).moved(z=half * 0.45).painted(cap))
    for angle in np.arange(bolts) * 2 * np.pi / bolts:
        bolt = cylinder(radius * 0.09, half * 0.25, radius * 0.02, 8)
        parts.append(bolt.moved(radius * 0.58 * np.cos(angle), radius * 0.58 * np.sin(angle), half * 0.6).painted(cap))
    return parts


def caster(radius: float, width: float, rubber: bpy.types.Material, metal: bpy.types.Material) -> list[Part]:
    """A small wheel with a disc in it."""
    disc = cylinder(radius * 0.62, width * 0.8, width * 0.08, 20).painted(metal)
    return [
        *tyre(radius, width, radius * 0.6, rubber, 24),
        disc,
        torus(radius * 0.3, width * 0.08, 16, 6).moved(z=width * 0.4).painted(rubber),
    ]
