"""Decomposition of meshes into convex parts."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from morse.assets.shapes.coarsen import coarsened
from morse.assets.shapes.convexity import hull_part, is_convex
from morse.assets.shapes.detect import primitive_of
from morse.assets.shapes.losses import Losses
from morse.assets.shapes.patches import Flatness, flat_patches
from morse.assets.shapes.plates import plates
from morse.assets.shapes.surface import Surface, clean_surface, components

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from morse.assets.shapes.part import Part

    Ints = NDArray[np.int64]

DEFAULT_LIMIT = 4096
"""Maximum number of parts of a mesh: the engine compiles that many static parts in about 0.2 s."""

_FLAT = Flatness(angle=0.02, distance=2e-3)
_FLAT_SHARE = 5e-4  # share of the diagonal: the same for small pieces
_COARSER = 1.4
_COARSEST = 1.0 / 3.0  # share of the diagonal


def convex_parts(
    vertices: ArrayLike, triangles: ArrayLike, *, limit: int = DEFAULT_LIMIT, warnings: list[str] | None = None
) -> list[Part]:
    """Decompose a mesh into primitives and convex parts, in the frame of the mesh.

    Each connected piece becomes one part if it is a primitive or convex. Any other piece becomes plates behind its flat
    patches, so that the visible surface is exact and hollows are kept. A piece that needs too many plates is simplified
    until the limit is met, or else replaced by its convex hull.

    Args:
        vertices: (V, 3) metres.
        triangles: (T, 3) indices, counter-clockwise seen from outside.
        limit: maximum number of parts, at least 1.
        warnings: list to which a sentence about lost accuracy is appended.

    Returns:
        The parts; an empty list for a mesh without area.

    Raises:
        ValueError: the limit is less than 1 or the arrays have other shapes.
    """
    if limit < 1:
        raise ValueError(f"convex_parts needs a limit of at least 1, given {limit}")
    surface = clean_surface(vertices, triangles)
    pieces = [surface.part(piece) for piece in components(surface)]
    pieces = [piece for piece in pieces if piece.areas.any()]
    if not pieces:
        return []
    alone = pieces[: limit // 2] if len(pieces) > limit else pieces
    rest = pieces[len(alone) :]
    groups = min(len(rest), limit - len(alone))
    hollow = _hollow(pieces)
    parts: list[Part] = []
    losses = Losses()
    for index, piece in enumerate(alone):
        budget = limit - len(parts) - groups - (len(alone) - index - 1)
        parts += _parts_of(piece, budget, hollow[index], losses)
    if rest:
        losses.grouped = [piece.diagonal for piece in rest]
        parts += _hulls_of_groups(rest, groups)
    if warnings is not None:
        warnings += losses.told(limit)
    return parts


def _parts_of(piece: Surface, budget: int, hollow: bool, losses: Losses) -> list[Part]:
    if not hollow:
        primitive = primitive_of(piece)
        if primitive is not None:
            return [primitive]
        if is_convex(piece):
            return [hull_part(piece.vertices)]
    size = piece.diagonal
    flatness = Flatness(_FLAT.angle, min(_FLAT.distance, _FLAT_SHARE * size))
    made = _plates_of(piece, flatness, budget)
    if made is not None:
        return made
    # A grid of triangles with cells of this width contains as many triangles as allowed. Flat areas need fewer.
    cell = size / math.sqrt(budget) / 2.0
    while cell < _COARSEST * size:
        made = _plates_of(coarsened(piece, cell), flatness, budget)
        if made:
            losses.coarse.append((cell * math.sqrt(3.0), size))
            return made
        cell *= _COARSER
    losses.hulls.append(size)
    return [hull_part(piece.vertices)]


def _plates_of(piece: Surface, flatness: Flatness, budget: int) -> list[Part] | None:
    patches = flat_patches(piece, flatness, budget)
    return None if patches is None else plates(piece, patches, budget)


def _hollow(pieces: list[Surface]) -> list[bool]:
    """Return whether each piece is a cavity or contains one; such a piece is not a solid."""
    lows = np.array([piece.vertices.min(axis=0) for piece in pieces])
    highs = np.array([piece.vertices.max(axis=0) for piece in pieces])
    hollow = np.zeros(len(pieces), dtype=bool)
    for index, piece in enumerate(pieces):
        if piece.signed_volume < 0.0 and piece.is_closed:
            hollow |= (lows <= lows[index]).all(axis=1) & (highs >= highs[index]).all(axis=1)
    return hollow.tolist()


def _hulls_of_groups(pieces: list[Surface], groups: int) -> list[Part]:
    """The convex hulls of the given number of groups of neighbouring pieces."""
    centres = np.array([piece.vertices.mean(axis=0) for piece in pieces])
    clusters = [np.arange(len(pieces))]
    while len(clusters) < groups:
        clusters.sort(key=len)
        widest = clusters.pop()
        axis = int(np.ptp(centres[widest], axis=0).argmax())
        order = widest[np.argsort(centres[widest, axis], kind="stable")]
        clusters += [order[: len(order) // 2], order[len(order) // 2 :]]
    return [hull_part(np.vstack([pieces[i].vertices for i in cluster])) for cluster in clusters]
