"""Shared parts of the outdoor worlds: the ground and the town."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from common.images import packed
from common.materials import material
from common.nature import Greens, broadleaf, hedge
from common.objects import empty, exact, hidden_box, solid, twin
from common.parts import rotation
from common.terrain import Terrain
from common.textures import speckle
from common.town import Masonry, house, quarter

if TYPE_CHECKING:
    from collections.abc import Sequence

    from common.objects import Triple
    from common.parts import Part

GROUND_AT = (0.02, -0.551, 0.0)
TOWN_TURN = -1.11
CELL = 6.0  # metres
#: m: thickness and height of the hedge around the ground, how deep it is in it, and its distance from the edge
HEDGE, ROOT, INSET = (1.1, 2.1), 0.6, 0.8


def town_ground(at: Triple, level: float, keep: Sequence[Triple]) -> list[Triple]:
    """Positions below the town and their height; none is near the positions to ``keep``."""
    frame = rotation(0, 0, np.degrees(TOWN_TURN))[:2, :2]
    corners = [(x, y) for x in (-21, -14, -7, 0, 7, 14, 21) for y in (-34, -28, -21, -14, -7, 0, 7, 14, 21, 28, 34)]
    below = [(*(frame @ np.array(c) + np.array(at[:2])), level + 0.08) for c in corners]
    return [p for p in below if all(np.hypot(p[0] - q[0], p[1] - q[1]) > 7 for q in keep)]


def ground(
    level: Sequence[Triple], dip: float, rise: float, seed: int, feet: Sequence[tuple[Triple, float]] = ()
) -> Terrain:
    """Land of 121 x 148 m, ``dip`` to ``rise`` high, that reaches the given heights.

    Nowhere below the ``feet``, positions with a radius, it is higher than these: what stands there does not overlap it.
    """
    terrain = Terrain((-60.458, -74.524), (60.542, 73.476), rise, level, seed)
    picture = packed("grass.jpg", speckle(512, "#6c9a4b", "#93b866", 61, coarse=4.0))
    paint = material("Grass", "#83ac5b", 0.95, image=picture)
    land = terrain.part(CELL, paint, 7.0).moved(-GROUND_AT[0], -GROUND_AT[1])
    heights = land.vertices[:, 2]
    for (x, y, z), radius in feet:
        # the corners of the squares that the foot touches
        apart = np.abs(land.vertices[:, :2] + GROUND_AT[:2] - (x, y))
        below = (apart < CELL + radius).all(axis=1)
        heights[below] = np.minimum(heights[below], z)
    heights[np.argmax(heights)] = rise
    away = np.where(heights == 0.0, np.hypot(land.vertices[:, 0], land.vertices[:, 1]), 0.0)
    heights[np.argmax(away)] = dip  # one hollow, far from everything
    size, middle = (121.0, 148.0, rise - dip), (0.022, 0.027, (rise + dip) / 2)
    exact("Ground", [land], size, middle, GROUND_AT, physics_type="STATIC", collision="mesh")
    border(land)
    return terrain


def border(land: Part) -> None:
    """A hedge along the edge of the ground, which follows its height: no robot falls off."""
    places = land.vertices + np.array([*GROUND_AT[:2], 0.0])
    low, high = places[:, :2].min(axis=0), places[:, :2].max(axis=0)
    rim = places[((np.abs(places[:, :2] - low) < 1e-6) | (np.abs(places[:, :2] - high) < 1e-6)).any(axis=1)]
    middle = (low + high) / 2
    # the corners first: the angle from the middle orders what is left and right of them
    rim = rim[np.argsort(np.arctan2(rim[:, 1] - middle[1], rim[:, 0] - middle[0]))]
    rim[:, :2] = np.clip(rim[:, :2], low + INSET, high - INSET)
    longest = max(float(np.linalg.norm(b - a)) for a, b in pairwise([*rim, rim[0]]))
    first = None
    for number, (a, b) in enumerate(pairwise([*rim, rim[0]])):
        x, y, z = (b - a).tolist()
        turned = (0.0, -math.atan2(z, math.hypot(x, y)), math.atan2(y, x))
        at = (*((a + b) / 2)[:2].tolist(), float(a[2] + b[2]) / 2 + HEDGE[1] / 2 - ROOT)
        options = {"physics_type": "STATIC", "collision": "box", "slip": True}
        if first is None:
            leaves = [
                material(f"Hedge {shade}", color, 0.9) for shade, color in (("Dark", "#3b7036"), ("Light", "#4f8a40"))
            ]
            parts = hedge(leaves, longest + 0.3, *HEDGE, 31)
            first = solid("Hedge", parts, at, turned, **options)
        else:
            twin(first, f"Hedge.{number:03}", at, turned, **options)


def town(terrain: Terrain, at: Triple, size: Triple, centre: Triple, keep_free: Sequence[Triple]) -> None:
    """Houses along two streets; none stands on a tree, or where the land below falls away."""
    still = {"physics_type": "STATIC"}
    root = empty("Buildings", (10.2, 0.867, -10.3), **still)
    masonry = Masonry.make()
    frame, foot = rotation(0, 0, np.degrees(TOWN_TURN))[:2, :2], at[2] + centre[2] - size[2] / 2
    trees = [frame.T @ (np.array(place[:2]) - np.array(at[:2])) for place in keep_free]
    parts = []
    for number, (x, y) in enumerate((x, y) for x in (-15.0, 15.0) for y in (-28.0, -14.0, 0.0, 14.0, 28.0)):
        width, depth = 12.0, 12.0 if number % 5 in (0, 4) else 9.0
        corners = np.array([(x + u * width / 2, y + v * depth / 2) for u in (-1, 1) for v in (-1, 1)])
        land = terrain(corners @ frame.T + np.array(at[:2]))
        free = all(abs(u - x) > width / 2 + 2.3 or abs(v - y) > depth / 2 + 2.3 for u, v in trees)
        if free and land.min() > foot - 0.1:
            parts += [p.moved(x, y) for p in house(masonry, width, depth, 2 + number % 2, number)]
    exact("City.3", parts, size, centre, at, (0, 0, TOWN_TURN), parent=root, collision="mesh", **still)


def grove(trees: Sequence[tuple[Triple, Triple, Triple, Triple, float]]) -> None:
    """Trees of one kind: position, positions of the shapes of trunk, crown and visible mesh, angle about Z."""
    greens = Greens.make()
    still = {"physics_type": "STATIC"}
    root_of_all = empty("Trees", (10.2, 0.867, -10.3), **still)
    first = None
    for number, (at, trunk_at, crown_at, seen_at, angle) in enumerate(trees):
        suffix, pose = (f".{number:03}" if number else ""), (0, 0, angle)
        root = empty(f"Tree{suffix}", at, pose, parent=root_of_all, **still)
        trunk = hidden_box(f"BB_Trunk{suffix}", (0.285, 0.285, 2.16), trunk_at, pose, parent=root, **still)
        hidden_box(f"BB_Leaves{suffix}", (2.3, 2.3, 2.3), crown_at, pose, parent=trunk, **still)
        show = {"parent": trunk, "physics_type": "NO_COLLISION"}
        if first is None:
            parts = broadleaf(greens, 5.2, 3.7, 0.13, seed=2)
            first = exact("Plane-Tree", parts, (3.68, 3.69, 5.19), (-0.182, 0.114, 2.54), seen_at, pose, **show)
        else:
            twin(first, f"Plane-Tree{suffix}", seen_at, pose, **show)


def block(name: str, at: Triple, size: Triple, centre: Triple, turn: float, seed: int, masonry: Masonry) -> None:
    """A quarter of a town that fills a box."""
    parts = quarter(masonry, size[0], size[1], size[2], seed)
    exact(name, parts, size, centre, at, (0, 0, turn), physics_type="STATIC", collision="mesh")
