"""The shadow map: distances to the nearest surface from the sun; the twin of ``c/draw_shadow.c``."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from morse.kernel.drawing.arrays import MIRRORED

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from morse.kernel.drawing.arrays import Drawing, Light, Poses

f = np.float32


def cast(drawing: Drawing, parts: NDArray[np.integer], poses: Poses, light: Light) -> NDArray[np.int32]:
    """Draw parts into the shadow map; returns the texels (N, 4) that each part may have filled."""
    shadow, s = light.shadow, light.sun
    assert shadow is not None
    height, width = shadow.shape
    size = np.array([width, height], np.float32)
    rectangles = np.zeros((len(parts), 4), np.int32)
    for row, part in zip(rectangles, parts.tolist(), strict=True):
        cluster, instance = drawing.parts[part, :2].tolist()
        first_vertex, vertices, first, count = drawing.clusters[cluster].tolist()
        m = poses.models[instance]
        a = [
            [
                s[4 * i] * m[n] + s[4 * i + 1] * m[4 + n] + s[4 * i + 2] * m[8 + n] + (s[4 * i + 3] if n == 3 else f(0))
                for n in range(4)
            ]
            for i in range(3)
        ]
        p = drawing.vertices["p"][first_vertex : first_vertex + vertices]
        light_space = np.stack(
            [a[i][0] * p[:, 0] + a[i][1] * p[:, 1] + a[i][2] * p[:, 2] + a[i][3] for i in range(3)], axis=1
        )
        low, high = light_space[:, :2].min(axis=0), light_space[:, :2].max(axis=0)
        row[:2] = np.maximum(np.minimum(low, size), 0)
        row[2:] = np.maximum(np.minimum(high + f(1), size), 0)
        # the back faces of closed parts are farther from the sun than their front faces
        back = f(1) if drawing.parts[part, 3] & MIRRORED else f(-1)
        for number in range(first, first + count):
            _fill(shadow, light_space[drawing.triangles[number, :3]], back if drawing.closed[number] else f(0))
    return rectangles


class ReferenceMovers:
    """The shadows of parts that may move; the twin of `morse.kernel.drawing.native.NativeMovers`.

    Args:
        parts: (M,) the parts.
        light: with the map, which has the shadows of all other parts already.

    Attributes:
        touched, extents: (M, 4) int32, the texels that each part may fill: x0, y0, x1, y1, one past the end.
    """

    def __init__(self, drawing: Drawing, parts: NDArray[np.integer], light: Light) -> None:
        assert light.shadow is not None
        self._drawing, self._parts, self._light = drawing, np.asarray(parts), light
        self._base = light.shadow.copy()
        self._models = np.zeros((len(parts), 12), np.float32)
        self.touched = self.extents = np.zeros((len(parts), 4), np.int32)

    def update(self, poses: Poses, cameras: NDArray[np.void], left_out: NDArray[np.bool_] | None = None) -> None:
        """Draw the shadows of parts that have moved again.

        Args:
            cameras: (K,) `CAMERA`; all shadows are drawn, whether a camera sees them or not.
            left_out: (M,) the parts whose shadows are not needed.
        """
        shadow = self._light.shadow
        assert shadow is not None
        now = poses.models[self._drawing.parts[self._parts, 1]]
        is_drawn = np.ones(len(now), bool) if left_out is None else ~left_out
        # without a pose, like an invisible object, so that a change of `left_out` counts as a motion
        now[~is_drawn] = 0.0
        has_moved = (now != self._models).any(axis=1)
        if not has_moved.any():
            return
        tiles = self.touched[has_moved]
        for x0, y0, x1, y1 in tiles.tolist():
            shadow[y0:y1, x0:x1] = self._base[y0:y1, x0:x1]
        # objects in the same region are rendered again as well
        mine, previous = self.touched[:, None], tiles[None]
        has_moved |= ((mine[..., :2] < previous[..., 2:]) & (previous[..., :2] < mine[..., 2:])).all(axis=2).any(axis=1)
        self._models = now
        self.touched[has_moved] = 0
        has_moved &= is_drawn
        if has_moved.any():
            with np.errstate(all="ignore"):
                self.touched[has_moved] = cast(self._drawing, self._parts[has_moved], poses, self._light)


def _fill(shadow: NDArray[np.float32], q: NDArray[np.float32], hidden: np.float32) -> None:
    height, width = shadow.shape
    o = q[0]
    bx, by, bz = q[1] - o
    cx, cy, cz = q[2] - o
    area = bx * cy - by * cx
    if area * hidden > 0:
        return
    left, right = o[0] + min(f(0), bx, cx), o[0] + max(f(0), bx, cx)
    top, bottom = o[1] + min(f(0), by, cy), o[1] + max(f(0), by, cy)
    if not (area > 0 or area < 0) or not (right >= 0.5 and bottom >= 0.5 and left < width and top < height):
        return
    x0, x1 = int(np.ceil(max(left, f(0.5)) - f(0.5))), int(min(right, f(width)) - f(0.5))
    y0, y1 = int(np.ceil(max(top, f(0.5)) - f(0.5))), int(min(bottom, f(height)) - f(0.5))
    if x1 < x0 or y1 < y0:
        return
    sign = f(1) if area > 0 else f(-1)
    dx, dy = (bz * cy - cz * by) / area, (cz * bx - bz * cx) / area
    fx = np.arange(x0, x1 + 1).astype(np.float32) + f(0.5)
    fy = (np.arange(y0, y1 + 1).astype(np.float32) + f(0.5))[:, None]
    part = shadow[y0 : y1 + 1, x0 : x1 + 1]
    inside = np.ones(part.shape, bool)
    for i in range(3):
        b, e = q[(i + 1) % 3], q[(i + 2) % 3]
        base = sign * ((e[0] - b[0]) * (fy - b[1]) + (e[1] - b[1]) * b[0])
        inside &= base + -sign * (e[1] - b[1]) * fx >= 0
    z = o[2] + dy * (fy - o[1]) - dx * o[0]
    d = z + dx * fx
    inside &= d > part
    part[inside] = d[inside]
