"""Finds the triangles that may be visible to a camera, and projects them; the twin of ``c/draw_project.c``."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from morse.kernel.drawing.arrays import CLOSED, DITHERED, DOUBLE_SIDED, MASKED, MIRRORED, MIXED, SOLID

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from morse.kernel.drawing.arrays import Drawing, Poses

_SMALLEST = np.float32(0.25)
# limits of projected coordinates and of the coefficients of 1 / depth, so that the values at all pixels are finite
_FARTHEST = 1e15
_LARGEST = np.float32(1e30)
# margin of clipped coordinates: pixels, and relative to their terms
_CLIP_MARGIN, _CLIP_ROUNDING = 1.0, 1e-14


@dataclass
class Projected:
    """Triangles in the image of a camera, in the order of parts.

    Attributes:
        e: (N, 3, 3) float32, the edges as planes (d/dx, d/dy, at pixel 0, 0).
        w: (N, 3) float32, 1 / depth as such a plane.
        box: (N, 4) pixels x0, y0, x1, y1, inclusive.
        triangle, part, material: (N,) indices in the drawing.
        back: (N,) whether the back face is visible.
    """

    e: NDArray[np.float32]
    w: NDArray[np.float32]
    box: NDArray[np.int64]
    triangle: NDArray[np.int64]
    part: NDArray[np.int64]
    material: NDArray[np.int64]
    back: NDArray[np.bool_]

    def __len__(self) -> int:
        return len(self.w)

    def vertices(self, drawing: Drawing, numbers: NDArray[np.integer]) -> np.ndarray:
        """(N, 3) `VERTEX`, the corners of some triangles."""
        first = drawing.clusters[drawing.parts[self.part[numbers], 0], 0]
        vertices: NDArray[np.void] = drawing.vertices[drawing.triangles[self.triangle[numbers], :3] + first[:, None]]
        return vertices


def project(drawing: Drawing, camera: NDArray[np.void], poses: Poses, samples: int) -> Projected:
    """The triangles that may be visible to a camera."""
    batches = [
        one
        for part in range(len(drawing.parts))
        if _is_level(drawing, camera, poses, part) and _may_be_seen(drawing, camera, poses, part)
        for one in [_part(drawing, camera, poses, part, 0.9 if samples > 1 else 0.5)]
    ]
    none = np.zeros(0, np.int64)
    empty = Projected(
        np.zeros((0, 3, 3), np.float32),
        np.zeros((0, 3), np.float32),
        np.zeros((0, 4), np.int64),
        none,
        none,
        none,
        np.zeros(0, bool),
    )
    columns = zip(*(vars(one).values() for one in [empty, *batches]), strict=True)
    return Projected(*(np.concatenate(column) for column in columns))


def _may_be_seen(drawing: Drawing, k: NDArray[np.void], poses: Poses, part: int) -> bool:
    cluster, instance = drawing.parts[part, :2]
    s, m, r = drawing.spheres[cluster], poses.models[instance].reshape(3, 4), k["axes"]
    fx, fy = k["fx"], k["fy"]
    side = [k["cx"], np.float32(k["width"]) - k["cx"], k["cy"], np.float32(k["height"]) - k["cy"]]
    length = [np.sqrt((fx * fx if i < 2 else fy * fy) + side[i] * side[i]) for i in range(4)]
    x = [m[i, 0] * s[0] + m[i, 1] * s[1] + m[i, 2] * s[2] + m[i, 3] - k["eye"][i] for i in range(3)]
    q = [r[3 * i] * x[0] + r[3 * i + 1] * x[1] + r[3 * i + 2] * x[2] for i in range(3)]
    size = s[3] * _stretch(m)
    if not (q[2] >= k["near"] - size and q[2] <= k["far"] + size):
        return False
    if q[2] > size and max(fx, fy) * size < _SMALLEST * q[2]:
        return False
    apart = (
        side[0] * q[2] + fx * q[0] < -size * length[0],
        side[1] * q[2] - fx * q[0] < -size * length[1],
    )
    if any(apart):
        return False
    return bool(side[2] * q[2] + fy * q[1] >= -size * length[2] and side[3] * q[2] - fy * q[1] >= -size * length[3])


def _is_level(drawing: Drawing, k: NDArray[np.void], poses: Poses, part: int) -> bool:
    """Whether a cluster belongs to the level of detail that a camera sees."""
    cluster, instance = drawing.parts[part, :2]
    s, m, r = drawing.levels[cluster], poses.models[instance].reshape(3, 4), k["axes"]
    depth, zero = np.float32(0), np.float32(0)
    for i in range(3):
        depth += r[6 + i] * (m[i, 0] * s[0] + m[i, 1] * s[1] + m[i, 2] * s[2] + m[i, 3] - k["eye"][i])
    scale = _scale(m)
    nearest = depth - s[3] * scale
    tolerance = nearest * k["tolerance"] if nearest > k["near"] else zero
    # the error of the last level is infinite
    return bool(s[4] * scale <= tolerance and not (s[5] < np.inf and s[5] * scale <= tolerance))


def _scale(m: NDArray[np.float32]) -> np.float32:
    """An upper bound of the largest stretch that is exact for rotations."""
    most = np.float32(0)
    for i in range(3):
        row = np.float32(0)
        for j in range(3):
            row += np.abs(m[0, i] * m[0, j] + m[1, i] * m[1, j] + m[2, i] * m[2, j])
        most = max(most, row)
    return np.float32(np.sqrt(most))


def _is_outside(drawing: Drawing, k: NDArray[np.void], poses: Poses, part: int) -> bool:
    """Whether the closed parts of a cluster are beyond the near plane."""
    cluster, instance = drawing.parts[part, :2]
    s, m, r = drawing.spheres[cluster], poses.models[instance].reshape(3, 4), k["axes"]
    x = [m[i, 0] * s[0] + m[i, 1] * s[1] + m[i, 2] * s[2] + m[i, 3] - k["eye"][i] for i in range(3)]
    depth = r[6] * x[0] + r[7] * x[1] + r[8] * x[2]
    return bool(depth - drawing.guards[cluster] * _stretch(m) >= k["near"])


def _stretch(m: NDArray[np.float32]) -> np.float32:
    """An upper bound of the largest stretch: the Frobenius norm, also for sheared parts."""
    scale = np.float32(0)
    for i in range(3):
        scale += m[0, i] * m[0, i] + m[1, i] * m[1, i] + m[2, i] * m[2, i]
    return np.float32(np.sqrt(scale))


def _part(drawing: Drawing, k: NDArray[np.void], poses: Poses, part: int, reach: float) -> Projected:
    cluster, instance, slots, flags = drawing.parts[part].tolist()
    first_vertex, vertices, first, count = drawing.clusters[cluster].tolist()
    a = _projection(k, poses.models[instance].reshape(3, 4))
    p = drawing.vertices["p"][first_vertex : first_vertex + vertices].astype(np.float64)
    screen = np.stack([a[i, 0] * p[:, 0] + a[i, 1] * p[:, 1] + a[i, 2] * p[:, 2] + a[i, 3] for i in range(3)], axis=1)
    flat = screen[:, :2] / np.where(screen[:, 2] < _cut(k), 1.0, screen[:, 2])[:, None]
    corners = drawing.triangles[first : first + count]
    q, at = screen[corners[:, :3]], flat[corners[:, :3]]
    material = drawing.slots[slots + corners[:, 3]].astype(np.int64)
    box, inside = _bounds(k, q, at, reach)
    e = np.stack([np.cross(q[:, (i + 1) % 3], q[:, (i + 2) % 3]) for i in range(3)], axis=1)
    volume = q[:, 0, 0] * e[:, 0, 0] + q[:, 0, 1] * e[:, 0, 1] + q[:, 0, 2] * e[:, 0, 2]
    back = (volume > 0) != bool(flags & MIRRORED)
    two_sided = drawing.materials["flags"][material] & DOUBLE_SIDED != 0
    near = ~(q[:, :, 2] > k["far"]).all(axis=1)
    selection = near & inside & ((volume > 0) | (volume < 0)) & (two_sided | ~back)
    if _is_outside(drawing, k, poses, part):
        holes = drawing.materials["flags"][material] & (MASKED | DITHERED) != 0
        kinds = CLOSED | MIXED if flags & SOLID else CLOSED
        selection &= ~back | holes | (drawing.closed[first : first + count] & kinds == 0)
    edges = np.where((volume > 0)[:, None, None], e, -e).astype(np.float32)
    inverse = ((e[:, 0] + e[:, 1] + e[:, 2]) / volume[:, None]).astype(np.float32)
    sizes = np.abs(inverse)
    selection &= (sizes[:, 0] + sizes[:, 1] + sizes[:, 2] < _LARGEST) & _is_finite(a, drawing.spheres[cluster])
    numbers = np.arange(first, first + count)
    return Projected(
        edges[selection], inverse[selection], box[selection], numbers[selection],
        np.full(int(selection.sum()), part), material[selection], back[selection],
    )  # fmt: skip


def _projection(k: NDArray[np.void], m: NDArray[np.float32]) -> NDArray[np.float64]:
    """(3, 4) mesh to (x w, y w, w)."""
    r = k["axes"].astype(np.float64)
    fx, fy, cx, cy = (float(k[name]) for name in ("fx", "fy", "cx", "cy"))
    x = m.astype(np.float64)
    x[:, 3] -= k["eye"].astype(np.float64)
    row = [r[3 * n] * x[0] + r[3 * n + 1] * x[1] + r[3 * n + 2] * x[2] for n in range(3)]
    return np.stack([fx * row[0] + cx * row[2], fy * row[1] + cy * row[2], row[2]])


def _is_finite(a: NDArray[np.float64], sphere: NDArray[np.float32]) -> bool:
    """Whether the coordinates of all vertices in a sphere are finite."""
    reach = np.abs(sphere[:3]).astype(np.float64) + float(sphere[3])
    most = np.abs(a[:, 3])
    for n in range(3):
        most = most + np.abs(a[:, n]) * reach[n]
    return bool((most < _FARTHEST).all())


def _cut(k: NDArray[np.void]) -> float:
    """The depth in front of which triangles are clipped for their bounds: no sample is visible there."""
    return float(k["near"]) / 2


def _bounds(
    k: NDArray[np.void], q: NDArray[np.float64], at: NDArray[np.float64], reach: float
) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
    """Pixels whose samples may lie in triangles, and whether there are any."""
    low, high = _visible(_cut(k), q, at)
    last = np.array([int(k["width"]) - 1, int(k["height"]) - 1])
    first = np.maximum(np.ceil(low - reach), 0.0)
    end = np.minimum(np.floor(high + (reach - 1)), last)
    fine = (q[:, :, 2] >= k["near"]).any(axis=1) & (first <= end).all(axis=1)
    box = np.where(fine[:, None], np.concatenate([first, end], axis=1), 0.0)
    return box.astype(np.int64), fine


def _visible(
    cut_depth: float, q: NDArray[np.float64], at: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Lowest and highest coordinates (N, 2) of the parts of triangles beyond a depth."""
    front = q[:, :, 2] >= cut_depth
    low = np.where(front[..., None], at, np.inf).min(axis=1)
    high = np.where(front[..., None], at, -np.inf).max(axis=1)
    for i in range(3):
        n = (i + 1) % 3
        crosses = front[:, i] != front[:, n]
        # the same numbers in both directions
        a, b = (np.where(front[:, [i]], q[:, u], q[:, v]) for u, v in ((n, i), (i, n)))
        t = (cut_depth - a[:, 2]) / (b[:, 2] - a[:, 2])
        place = (a[:, :2] + t[:, None] * (b[:, :2] - a[:, :2])) / cut_depth
        margin = _CLIP_MARGIN + _CLIP_ROUNDING * (np.abs(a[:, :2]) + np.abs(b[:, :2])) / cut_depth
        low = np.where(crosses[:, None], np.minimum(low, place - margin), low)
        high = np.where(crosses[:, None], np.maximum(high, place + margin), high)
    return low, high
