"""Decomposition of meshes into convex parts: plates, then cuts."""

from __future__ import annotations

import math
from bisect import insort
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from morse.assets.shapes.budget import decomposed
from morse.assets.shapes.detect import primitive_of
from morse.assets.shapes.parts import ConvexPart, Part, Primitive, hull_part, is_convex
from morse.assets.shapes.polygons import convex_polygons, rectangles
from morse.assets.shapes.surface import (
    Flatness,
    Surface,
    clean_surface,
    components,
    flat_patches,
    measured,
    open_edges,
    outline,
    with_three_corners,
)
from morse.mathutils.portable import matmul, norm

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from morse.assets.shapes.surface import Patch

    Ints = NDArray[np.int64]
    Floats = NDArray[np.float64]

_THICKNESS = 0.05  # thickness as a share of the square root of the area: a wall is thicker than a picture frame …
_THINNEST, _THICKEST = 0.005, 0.1  # … within these limits, metres: fast objects pass through thin plates
_HALVINGS = 6  # of the thickness at most, until a part of the plate is behind the neighbouring faces
_SAME_AREA = 1e-3
_SQUARE = 1e-3  # sine of the largest error of the corners of a rectangle


def plates(surface: Surface, patches: list[Patch], limit: int) -> list[Part] | None:
    """Return convex plates behind patches, not thicker than the solid behind them; None if more than `limit`."""
    parts: list[Part] = []
    thickness = _thicknesses(surface, patches)
    for patch, thick in zip(patches, thickness, strict=True):
        for polygon in _polygons(surface, patch):
            if len(parts) == limit:
                return None
            parts.append(_plate(polygon, patch, thick))
    return parts


def _polygons(surface: Surface, patch: Patch) -> list[Floats]:
    """The patch as convex polygons (N, 3), counter-clockwise seen from outside."""
    if len(patch.triangles) == 1:
        return [surface.vertices[surface.triangles[patch.triangles[0]]]]
    used_vertices, triangles = np.unique(surface.triangles[patch.triangles], return_inverse=True)
    points = surface.vertices[used_vertices]
    place = {vertex: index for index, vertex in enumerate(used_vertices.tolist())}
    loops = [[place[vertex] for vertex in loop] for loop in outline(surface, patch.triangles)]
    start = np.eye(3)[int(np.abs(patch.normal).argmin())]
    x = np.cross(start, patch.normal)
    x /= norm(x)
    axes = np.column_stack([x, np.cross(patch.normal, x)])
    flat = matmul(points, axes)
    polygons = convex_polygons(flat, loops, triangles.reshape(-1, 3).tolist())
    boxes = rectangles(flat, loops) if len(polygons) > 1 else None
    if boxes is None or not _fill_the_same(boxes, patch, surface):
        return [points[polygon] for polygon in polygons]
    return [matmul(box, axes.T) + patch.normal * patch.offset for box in boxes]


def _fill_the_same(boxes: list[Floats], patch: Patch, surface: Surface) -> bool:
    patch_area = float(surface.areas[patch.triangles].sum())
    box_area = sum(float(norm(box[1] - box[0]) * norm(box[3] - box[0])) for box in boxes)
    return abs(box_area - patch_area) <= _SAME_AREA * patch_area


def _thicknesses(surface: Surface, patches: list[Patch]) -> list[float]:
    """Return the thickness of each plate, m, from its size, limited by the opposite face of a thin wall."""
    if not patches:
        return []
    normals = np.array([patch.normal for patch in patches])
    areas = np.array([surface.areas[patch.triangles].sum() for patch in patches])
    corners = [surface.vertices[surface.triangles[patch.triangles]].reshape(-1, 3) for patch in patches]
    lows = np.array([points.min(axis=0) for points in corners])
    highs = np.array([points.max(axis=0) for points in corners])
    centres = (lows + highs) / 2.0
    root = np.sqrt(areas)
    smallest = np.minimum(_THINNEST, root / 4.0)
    thickness = np.clip(_THICKNESS * root, smallest, _THICKEST)
    result = []
    for index, normal in enumerate(normals):
        inner = normal * thickness[index]
        low = np.minimum(lows[index], lows[index] - inner)
        high = np.maximum(highs[index], highs[index] - inner)
        depth = matmul(centres[index] - centres, normal)
        opposite = (
            (matmul(normals, normal) < -0.9)
            & (depth > -1e-9)
            & (depth < thickness[index])
            & (lows <= high).all(axis=1)
            & (highs >= low).all(axis=1)
        )
        depths = depth[opposite]
        result.append(float(max(depths.min(), smallest[index])) if depths.size else float(thickness[index]))
    return result


def _plate(polygon: Floats, patch: Patch, thickness: float) -> Part:
    for _ in range(_HALVINGS):
        whole = bottom = polygon - patch.normal * thickness
        for plane in patch.acute:
            bottom = _behind(bottom, plane)
        if np.array_equal(bottom, whole):
            return _as_box(polygon, patch.normal, thickness) or ConvexPart(np.vstack([polygon, bottom]))
        if len(bottom):
            return ConvexPart(np.vstack([polygon, bottom]))
        thickness /= 2.0
    return ConvexPart(np.vstack([polygon, polygon.mean(axis=0) - patch.normal * thickness]))


def _as_box(polygon: Floats, normal: Floats, thickness: float) -> Primitive | None:
    if len(polygon) != 4:
        return None
    a, b, c, d = polygon
    x, y = b - a, d - a
    long, wide = float(norm(x)), float(norm(y))
    tolerance = _SQUARE * min(long, wide)
    if norm(a + c - b - d) > tolerance or abs(matmul(x, y)) > _SQUARE * long * wide:
        return None
    if max(abs(matmul(x, normal)), abs(matmul(y, normal))) > tolerance:
        return None
    x = x / long
    rotation = np.column_stack([x, np.cross(normal, x), normal])
    centre = polygon.mean(axis=0) - normal * (thickness / 2.0)
    return Primitive("box", (long / 2.0, wide / 2.0, thickness / 2.0), centre, rotation)


def _behind(polygon: Floats, plane: Floats) -> Floats:
    """The part of a convex polygon (N, 3) behind a plane (normal, offset): I. Sutherland, G. Hodgman (1974)."""
    heights = matmul(polygon, plane[:3]) - plane[3]
    candidates = []
    for index, height in enumerate(heights):
        before = heights[index - 1]
        if (height > 0.0) != (before > 0.0):
            candidates.append(polygon[index - 1] + (polygon[index] - polygon[index - 1]) * (before / (before - height)))
        if height <= 0.0:
            candidates.append(polygon[index])
    return np.array(candidates).reshape(-1, 3)


#: the cube of the number of vertices fits into 64 bits
_MOST_KEYS = 1 << 21


def coarsened(surface: Surface, cell: float, bends: NDArray[np.float64] | None = None) -> Surface:
    """Simplify a surface to one vertex per grid cell, the vertex where the surface bends most.

    J. Rossignac and P. Borrel, "Multi-resolution 3D approximations for rendering complex scenes" (1993).
    No vertex moves farther than the diagonal of a cell.

    Args:
        surface: the surface.
        cell: width of the cells, metres.
        bends: (V,) the `sharpness` of the surface, if it is simplified several times.
    """
    low = surface.vertices.min(axis=0)
    x, y, z = np.floor((surface.vertices - low) / cell).astype(np.int64).T
    key = (x << 42) + (y << 21) + z
    order = np.lexsort((-(sharpness(surface) if bends is None else bends), key))
    _, first, group = np.unique(key[order], return_index=True, return_inverse=True)
    representatives = np.empty(len(key), dtype=np.int64)
    representatives[order] = order[first][group.ravel()]
    faces = with_three_corners(representatives[surface.triangles])
    used_vertices, faces = np.unique(faces, return_inverse=True)
    faces = faces.reshape(-1, 3)
    a, b, c = np.sort(faces, axis=1).T
    if len(used_vertices) < _MOST_KEYS:
        _, once = np.unique((a * len(used_vertices) + b) * len(used_vertices) + c, return_index=True)
    else:
        _, once = np.unique(np.column_stack([a, b, c]), axis=0, return_index=True)
    return measured(surface.vertices[used_vertices], faces[once])


def sharpness(surface: Surface) -> NDArray[np.float64]:
    """(V,) 0 on flat areas, up to 1 where the normals of the faces differ most; 2 at the rim, up to 3 at corners."""
    weights = np.repeat(surface.areas, 3)
    total = np.bincount(surface.triangles.ravel(), weights=weights, minlength=len(surface.vertices))
    mean = _sums(surface, surface.triangles.ravel(), np.repeat(surface.normals, 3, axis=0) * weights[:, None])
    sharpness = 1.0 - np.linalg.norm(mean, axis=1) / np.maximum(total, 1e-300)
    starts, ends = open_edges(surface.triangles, len(surface.vertices))
    along = surface.vertices[ends] - surface.vertices[starts]
    along /= np.maximum(np.linalg.norm(along, axis=1), 1e-300)[:, None]
    straight = np.linalg.norm(_sums(surface, starts, along) + _sums(surface, ends, along), axis=1) / 2.0
    sharpness[starts] = 3.0 - straight[starts]
    # rounded, so that the choice of a vertex does not depend on the last bit
    bent: NDArray[np.float64] = np.round(sharpness, 9)
    return bent


def _sums(surface: Surface, vertices: NDArray[np.int64], vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    """(V, 3) sums of the vectors given to each vertex."""
    size = len(surface.vertices)
    return np.column_stack([np.bincount(vertices, weights=column, minlength=size) for column in vectors.T])


@dataclass(slots=True)
class Losses:
    """The record of lost accuracy.

    Attributes:
        coarse: error and size of each piece that was simplified, m.
        hulls: size of each piece that was replaced by its convex hull, m.
        grouped: size of each piece that shares a hull with other pieces, m, the largest first.
    """

    coarse: list[tuple[float, float]] = field(default_factory=list)
    hulls: list[float] = field(default_factory=list)
    grouped: list[float] = field(default_factory=list)

    def told(self, limit: int) -> list[str]:
        """Return a sentence for the user if the limit of parts reduced the accuracy; otherwise an empty string."""
        parts = []
        if self.coarse:
            error, size = max(self.coarse)
            parts.append(f"{_pieces(self.coarse, size)} simplified, with an error of up to {error:.2g} m")
        if self.hulls:
            parts.append(f"{_pieces(self.hulls, max(self.hulls))} replaced by the convex hull, which fills cavities")
        if self.grouped:
            parts.append(f"{_pieces(self.grouped, self.grouped[0])} combined with neighbours into hulls")
        if not parts:
            return []
        return [
            f"the mesh has too many faces for {limit} convex parts: {'; '.join(parts)}. "
            f"Give it collision shapes of its own, or fewer faces"
        ]


def _pieces(sizes: list[float] | list[tuple[float, float]], size: float) -> str:
    return f"a piece {size:.3g} m across was" if len(sizes) == 1 else f"{len(sizes)} pieces of up to {size:.3g} m were"


DEFAULT_LIMIT = 4096
"""Maximum number of parts of a mesh: the engine compiles that many static parts in about 0.2 s."""

_FEWEST = 4  # triangles of a solid: fewer have no volume
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
    pieces = [piece for piece in components(surface) if surface.areas[piece].any()]
    if not pieces:
        return []
    count = limit // 2 if len(pieces) > limit else len(pieces)
    # there may be a hundred thousand others: no surface of its own is made for each of them
    alone, rest = [surface.part(piece) for piece in pieces[:count]], pieces[count:]
    groups = min(len(rest), limit - len(alone))
    hollow = _hollow(alone)
    parts: list[Part] = []
    losses = Losses()
    for index, piece in enumerate(alone):
        budget = limit - len(parts) - groups - (len(alone) - index - 1)
        parts += _parts_of(piece, budget, hollow[index], losses)
    if rest:
        parts += _hulls_of_groups(surface, rest, groups, losses)
    if warnings is not None:
        warnings += losses.told(limit)
    return parts


def few_parts(vertices: ArrayLike, triangles: ArrayLike, limit: int) -> list[Part]:
    """Decompose a mesh that moves into a few parts, in the frame of the mesh.

    If the parts of `convex_parts` are few enough, they are used. Otherwise, pieces that are neither primitives nor
    convex are approximated (`morse.assets.shapes.budget`).

    Args:
        vertices: (V, 3) metres.
        triangles: (T, 3) indices, counter-clockwise seen from outside.
        limit: maximum number of parts, at least 1.

    Returns:
        The parts; an empty list for a mesh without area.
    """
    surface = clean_surface(vertices, triangles)
    pieces = [piece for piece in components(surface) if surface.areas[piece].any()]
    if not pieces:
        return []
    if len(pieces) > limit:
        return [*decomposed(surface.corners[np.concatenate(pieces)], limit)]
    alone = [surface.part(piece) for piece in pieces]
    exact: list[Part] = []
    rough: list[Surface] = []
    for piece, hollow in zip(alone, _hollow(alone), strict=True):
        solid = None if hollow else _solid_of(piece)
        if solid is None:
            rough.append(piece)
        else:
            exact.append(solid)
    budget = limit - len(exact)
    plate_parts: list[Part] = []
    for piece in rough:
        some = _plates_of(piece, _flatness(piece), budget - len(plate_parts)) if budget > len(plate_parts) else None
        if some is None:
            return [*exact, *decomposed(np.concatenate([piece.corners for piece in rough]), budget)]
        plate_parts += some
    return exact + plate_parts


def _solid_of(piece: Surface) -> Part | None:
    """The primitive or the hull that a piece is; None if it is neither."""
    if len(piece.triangles) < _FEWEST:
        return None
    return primitive_of(piece) or (hull_part(piece.vertices) if is_convex(piece) else None)


def _flatness(piece: Surface) -> Flatness:
    return Flatness(_FLAT.angle, min(_FLAT.distance, _FLAT_SHARE * piece.diagonal))


def _parts_of(piece: Surface, budget: int, hollow: bool, losses: Losses) -> list[Part]:
    solid = None if hollow else _solid_of(piece)
    if solid is not None:
        return [solid]
    size, flatness = piece.diagonal, _flatness(piece)
    plate_parts = _plates_of(piece, flatness, budget)
    if plate_parts is not None:
        return plate_parts
    # A grid of triangles with cells of this width contains as many triangles as allowed. Flat areas need fewer.
    cell = size / math.sqrt(budget) / 2.0
    bends = sharpness(piece)
    while cell < _COARSEST * size:
        plate_parts = _plates_of(coarsened(piece, cell, bends), flatness, budget)
        if plate_parts:
            losses.coarse.append((cell * math.sqrt(3.0), size))
            return plate_parts
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


def _hulls_of_groups(surface: Surface, pieces: list[Ints], groups: int, losses: Losses) -> list[Part]:
    """The convex hulls of the given number of groups of neighbouring pieces."""
    corners = surface.triangles[np.concatenate(pieces)]
    owners = np.repeat(np.arange(len(pieces)), [3 * len(piece) for piece in pieces])
    # each vertex once for each piece: those of a piece are neighbours
    pairs = np.sort(owners * len(surface.vertices) + corners.ravel())
    owners, used_vertices = np.divmod(pairs[np.append(True, pairs[1:] != pairs[:-1])], len(surface.vertices))
    points, starts = surface.vertices[used_vertices], np.searchsorted(owners, np.arange(len(pieces)))
    spans = np.maximum.reduceat(points, starts) - np.minimum.reduceat(points, starts)
    losses.grouped = np.sqrt((spans * spans).sum(axis=1)).tolist()
    centres = np.add.reduceat(points, starts) / np.bincount(owners)[:, None]
    clusters: list[Ints] = []
    halves = [np.arange(len(pieces))]
    while len(clusters) + len(halves) < groups:
        for half in halves:
            insort(clusters, half, key=len)
        widest = clusters.pop()
        axis = int(np.ptp(centres[widest], axis=0).argmax())
        order = widest[np.argsort(centres[widest, axis], kind="stable")]
        halves = [order[: len(order) // 2], order[len(order) // 2 :]]
    clusters += halves
    cluster_of = np.empty(len(pieces), dtype=np.int64)
    for number, cluster in enumerate(clusters):
        cluster_of[cluster] = number
    owners = cluster_of[owners]
    points = points[np.argsort(owners, kind="stable")]
    return [hull_part(some, groups) for some in np.split(points, np.cumsum(np.bincount(owners))[:-1])]
