"""Converts flat patches into solid plates whose outer face is the visible surface."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from morse.assets.shapes.part import ConvexPart, Part, Primitive
from morse.assets.shapes.patches import outline
from morse.assets.shapes.polygons import convex_polygons
from morse.assets.shapes.rectangles import rectangles
from morse.mathutils.portable import matmul, norm

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from morse.assets.shapes.patches import Patch
    from morse.assets.shapes.surface import Surface

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
