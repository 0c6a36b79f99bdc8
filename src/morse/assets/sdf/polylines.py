"""Polygons that are raised to prisms."""

from __future__ import annotations

from typing import TYPE_CHECKING

import mapbox_earcut
import numpy as np

from morse.assets.gazebo.values import ValueMistakeError, number, vector
from morse.scene import Mesh

if TYPE_CHECKING:
    from xml.etree.ElementTree import Element

    from numpy.typing import NDArray

    Ring = NDArray[np.float64]

#: corners of all polygons together
_MOST_CORNERS = 5000


def extruded(element: Element, name: str) -> Mesh:
    """The prism of an element ``polyline``; polygons within its first one are holes.

    Raises:
        ValueMistakeError: it has no area or no height, or too many corners.
    """
    height = number(element, "height", 1.0)
    polygons = [element, *element.findall("polyline")]
    rings = [ring for one in polygons if len(ring := _ring(one)) >= 3]
    if not rings or height <= 0.0:
        raise ValueMistakeError("it has no corners or no height")
    if sum(map(len, rings)) > _MOST_CORNERS:
        raise ValueMistakeError(f"it has more than {_MOST_CORNERS} corners")
    rings = [ring if (_area(ring) > 0.0) == (number == 0) else ring[::-1] for number, ring in enumerate(rings)]
    points = np.concatenate(rings)
    ends = np.cumsum([len(ring) for ring in rings]).astype(np.uint32)
    top = mapbox_earcut.triangulate_float64(points, ends).astype(np.int64).reshape(-1, 3)
    if not len(top):
        raise ValueMistakeError("its corners enclose no area")
    corners = points[top]
    areas = _cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    top[areas < 0.0] = top[areas < 0.0][:, ::-1]
    count = len(points)
    walls, begin = [], 0
    for ring in rings:
        one = begin + np.arange(len(ring))
        other = begin + np.roll(np.arange(len(ring)), -1)
        walls += [np.stack([one, other, other + count], axis=1), np.stack([one, other + count, one + count], axis=1)]
        begin += len(ring)
    triangles = np.concatenate([top + count, top[:, ::-1], *walls]).astype(np.int32)
    vertices = np.zeros((2 * count, 3), dtype=np.float32)
    vertices[:count, :2] = vertices[count:, :2] = points
    vertices[count:, 2] = height
    return Mesh(name, vertices, triangles, np.zeros(len(triangles), dtype=np.int32))


def _ring(element: Element) -> Ring:
    """The corners of a polygon (N, 2), without repeated ones."""
    corners: list[tuple[float, ...]] = []
    for point in element.findall("point")[: _MOST_CORNERS + 1]:
        if not (point.text or "").strip():
            continue
        x, y = vector(point, ".", (0.0, 0.0))
        if not corners or (x, y) != corners[-1]:
            corners.append((x, y))
    if len(corners) > 1 and corners[0] == corners[-1]:
        corners.pop()
    return np.array(corners, dtype=np.float64).reshape(-1, 2)


def _area(ring: Ring) -> float:
    return float(_cross(ring, np.roll(ring, -1, axis=0)).sum())


def _cross(a: Ring, b: Ring) -> NDArray[np.float64]:
    product: NDArray[np.float64] = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    return product
