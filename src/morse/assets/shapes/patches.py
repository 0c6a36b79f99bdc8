"""Flat patches of a surface."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from morse.assets.shapes.surface import edge_neighbours, open_edges
from morse.mathutils.portable import matmul

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from morse.assets.shapes.surface import Surface

    Floats = NDArray[np.float64]
    Ints = NDArray[np.int64]


#: number of triangles whose neighbours are examined together
_AHEAD = 1024


@dataclass(frozen=True, slots=True)
class Flatness:
    """The tolerances for triangles of a flat patch.

    Attributes:
        angle: largest angle between a triangle and the plane, rad.
        distance: largest distance of a corner from the plane, m.
    """

    angle: float
    distance: float


@dataclass(eq=False, slots=True)
class Patch:
    """Neighbouring triangles in one plane.

    Attributes:
        triangles: (N,) indices of the triangles.
        normal: (3,) normal of the plane.
        offset: metres from the origin to the plane along the normal.
        acute: (K, 4) planes (normal, offset) of patches that meet this one at an acute interior angle.
    """

    triangles: Ints
    normal: Floats
    offset: float
    acute: Floats


def flat_patches(surface: Surface, flatness: Flatness, limit: int) -> list[Patch] | None:
    """Divide a surface into flat patches, grown from its largest triangles; None if there are more than `limit`.

    Triangles are compared with the first triangle of a patch, so that a curved surface does not become one patch.
    """
    across = edge_neighbours(surface)
    label = np.where(surface.areas > 0.0, -1, -2)
    slope = math.cos(flatness.angle)
    seeds = np.argsort(-surface.areas, kind="stable")
    offsets = np.einsum("ij,ij->i", surface.normals, surface.vertices[surface.triangles[:, 0]])
    patch_numbers: list[int] = []
    grows = _Growing(surface, across, flatness, offsets)
    for place, seed in enumerate(seeds.tolist()):
        if place % _AHEAD == 0:
            grows.look(seeds[place : place + _AHEAD])
        if label[seed] != -1:
            continue
        if len(patch_numbers) == limit:
            return None
        normal, offset = surface.normals[seed], offsets[seed]
        number = len(patch_numbers)
        label[seed] = number
        patch_numbers.append(seed)
        # most patches of a surface that is nowhere flat have one triangle
        front = np.array([seed] if grows.seeds[place % _AHEAD] else [], dtype=np.int64)
        while front.size:
            near = across[front].ravel()
            near = np.unique(near[near >= 0])
            near = near[label[near] == -1]
            lies = matmul(surface.normals[near], normal) >= slope
            near = near[lies]
            heights = matmul(surface.vertices[surface.triangles[near]], normal) - offset
            front = near[(np.abs(heights) <= flatness.distance).all(axis=1)]
            label[front] = number
    order = np.argsort(label, kind="stable")
    order = order[label[order] >= 0]
    groups = np.split(order, np.flatnonzero(np.diff(label[order])) + 1) if patch_numbers else []
    acute = _acute_neighbours(surface, across, label, np.array(patch_numbers, dtype=np.int64), offsets)
    return [
        Patch(group, surface.normals[seed], float(offsets[seed]), planes)
        for group, seed, planes in zip(groups, patch_numbers, acute, strict=True)
    ]


class _Growing:
    """Finds out for many triangles at once whether one of their neighbours may belong to the same patch.

    Attributes:
        seeds: for each of the triangles that `look` was given.
    """

    def __init__(self, surface: Surface, across: Ints, flatness: Flatness, offsets: Floats) -> None:
        self._surface, self._across, self._offsets = surface, across, offsets
        # wider by the rounding of the sums: what belongs to the patch is decided when it grows
        self._slope = math.cos(flatness.angle) - 1e-9
        self._distance = flatness.distance + 1e-9 * (surface.diagonal + float(np.abs(offsets).max(initial=0.0)))
        self.seeds: list[bool] = []

    def look(self, seeds: Ints) -> None:
        surface, near = self._surface, self._across[seeds]
        normals = surface.normals[seeds]
        alike = np.einsum("sj,snj->sn", normals, surface.normals[near]) >= self._slope
        corners = surface.vertices[surface.triangles[near]]
        heights = np.einsum("sj,sncj->snc", normals, corners) - self._offsets[seeds][:, None, None]
        close = (np.abs(heights) <= self._distance).all(axis=2)
        self.seeds = ((near >= 0) & alike & close).any(axis=1).tolist()


def _acute_neighbours(surface: Surface, across: Ints, label: Ints, seeds: Ints, offsets: Floats) -> list[Floats]:
    """Return for each patch the planes of its neighbours at an acute interior angle."""
    one, other = np.repeat(np.arange(len(across)), 3), across.ravel()
    has_neighbour = other >= 0
    one, other = one[has_neighbour], other[has_neighbour]
    mine, theirs = label[one], label[other]
    has_neighbour = (mine >= 0) & (theirs >= 0) & (mine != theirs)
    one, other, mine, theirs = one[has_neighbour], other[has_neighbour], mine[has_neighbour], theirs[has_neighbour]
    leans_back = np.einsum("ij,ij->i", surface.normals[one], surface.normals[other]) < -1e-3
    centres = surface.corners[other].mean(axis=1)
    behind = np.einsum("ij,ij->i", surface.normals[one], centres) < offsets[one]
    has_neighbour = leans_back & behind
    pairs = (
        np.unique(mine[has_neighbour] * len(seeds) + theirs[has_neighbour])
        if len(seeds)
        else np.empty(0, dtype=np.int64)
    )
    planes = np.column_stack([surface.normals[seeds], offsets[seeds]])
    cuts = np.searchsorted(pairs // max(1, len(seeds)), np.arange(1, len(seeds)))
    return [planes[group % len(seeds)] for group in np.split(pairs, cuts)] if len(seeds) else []


def outline(surface: Surface, triangles: Ints) -> list[list[int]]:
    """The closed loops of vertices around some triangles: outer loops are counter-clockwise, holes clockwise."""
    starts, ends = open_edges(surface.triangles[triangles], len(surface.vertices))
    following: dict[int, list[int]] = {}
    for start, end in zip(starts.tolist(), ends.tolist(), strict=True):
        following.setdefault(start, []).append(end)
    loops = []
    while following:
        first = next(iter(following))
        loop = [first]
        here = first
        while here in following:
            after = following[here].pop()
            if not following[here]:
                del following[here]
            if after == first:
                break
            loop.append(after)
            here = after
        loops.append(loop)
    return loops
