"""Which pixels geoms may fill, and which translucent ones are drawn together."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from morse.eyes.geoms import (
    BOX,
    CAPSULE,
    CYLINDER,
    ELLIPSOID,
    FLEX,
    HFIELD,
    LINE,
    LINEBOX,
    LINES,
    MESH,
    PLANE,
    SKIN,
    SPHERE,
    widths_of,
)

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from morse.eyes.picture import View

#: geoms that are within a box of their sizes; with the caps of a capsule
_SOLIDS = (SPHERE, ELLIPSOID, CAPSULE, CYLINDER, BOX, LINEBOX)
_CORNERS = np.array([[x, y, z] for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)])
_EDGES = np.array([[n, n | bit] for bit in (1, 2, 4) for n in range(8) if not n & bit])
_ONE_EDGE = np.array([[0, 1]])
#: number of layers of translucent geoms, beyond which those of equal opacity do not show each other
_MOST_LAYERS = 12
#: the same of lines, which fill few pixels: the rays of range finders overlap where they begin
_MOST_LINES = 32


def reach_of(g: NDArray[np.void]) -> NDArray[np.float32]:
    """(...) radii of spheres around the positions of geoms, m."""
    size = np.abs(g["size"])
    own = np.sqrt((size**2).sum(axis=-1)) + size.max(axis=-1)
    known = g["modelrbound"] if "modelrbound" in (g.dtype.names or ()) else np.zeros(g.shape)
    return np.asarray(np.where(known > 0, known, own), np.float32)


def layers_of(
    g: NDArray[np.void], numbers: NDArray[np.intp], opacity: NDArray[np.float32], view: View, linewidth: float
) -> list[tuple[list[int], tuple[int, int, int, int]]]:
    """Geoms that are drawn together, the farthest first, and the pixels around them."""
    numbers = numbers[np.isfinite(g["pos"][numbers]).all(axis=1)]
    far = dict(zip(numbers.tolist(), ((g["pos"][numbers] - view.eye) * view.axes[2]).sum(axis=1), strict=True))
    lines = np.isin(g["type"], LINES)
    many = {True: int(lines[numbers].sum()) > _MOST_LINES, False: int((~lines[numbers]).sum()) > _MOST_LAYERS}
    layers: list[tuple[list[int], list[tuple[int, int, int, int]]]] = []
    for number in sorted(numbers.tolist(), key=lambda n: -far[n]):
        box = _box_of(g[number], view, linewidth)
        if box is None:
            continue
        last = layers[-1] if layers else None
        if last is not None and opacity[last[0][0]] == opacity[number]:
            apart = all(box[0] >= one[2] or one[0] >= box[2] or box[1] >= one[3] or one[1] >= box[3] for one in last[1])
            if apart or many[bool(lines[number])]:
                last[0].append(number)
                last[1].append(box)
                continue
        layers.append(([number], [box]))
    return [
        (members, tuple(int(f(box[i] for box in boxes)) for i, f in enumerate((min, min, max, max))))  # type: ignore[misc]
        for members, boxes in layers
    ]


def _box_of(geom: np.void, view: View, linewidth: float) -> tuple[int, int, int, int] | None:
    """The pixels that a geom may fill: first column and row, and those after the last ones; None for none."""
    if geom["type"] == PLANE:
        return 0, 0, view.width, view.height
    if geom["type"] in (SKIN, FLEX):
        return 0, 0, view.width, view.height
    width = float(widths_of(geom, linewidth)) if geom["type"] in LINES else 0.0
    if geom["type"] == LINE:
        ends = np.array([geom["pos"], geom["pos"] + geom["mat"].reshape(3, 3)[:, 2] * geom["size"][2]], np.float64)
        return _around(_before(view.near, ((ends[:, None] - view.eye) * view.axes).sum(axis=2), _ONE_EDGE), view, width)
    if geom["type"] in _SOLIDS:
        half = np.abs(geom["size"].astype(np.float64))
        half[2] += half[0] if geom["type"] == CAPSULE else 0.0
        corners = (geom["pos"] - view.eye) + (geom["mat"].reshape(1, 3, 3) * (_CORNERS * half)[:, None]).sum(axis=2)
        return _around(_before(view.near, (corners[:, None] * view.axes).sum(axis=2), _EDGES), view, width)
    reach = float(reach_of(np.array([geom]))[0]) * (2.0 if geom["type"] in (MESH, HFIELD) else 1.0)
    x, y, depth = ((geom["pos"] - view.eye) * view.axes).sum(axis=1)
    if not math.isfinite(depth + reach):
        return None
    near = depth - reach
    if depth + reach < view.near:
        return None
    if near < view.near:
        return 0, 0, view.width, view.height
    bounds: list[tuple[float, float]] = []
    for at, focal, middle in ((x, view.fx, view.cx), (y, view.fy, view.cy)):
        # the nearer end of the sphere is farther from the middle of the picture
        scales = (1.0, 1.0) if view.parallel else (near, depth + reach)
        low, high = (
            focal * (at + side * reach) / scales[0 if (at + side * reach) * side > 0 else 1] for side in (-1, 1)
        )
        bounds.append((low + middle, high + middle))
    return _pixels(bounds[0], bounds[1], view)


def _around(points: NDArray[np.float64], view: View, width: float = 0.0) -> tuple[int, int, int, int] | None:
    """The pixels around points in the axes of a camera (N, 3), and half a width, pixels; None for none."""
    if not len(points) or not np.isfinite(points).all():
        return None
    x, y, depths = points.T
    if view.parallel:
        depths = np.ones_like(depths)
    columns, rows, half = view.fx * x / depths + view.cx, view.fy * y / depths + view.cy, abs(width) / 2
    return _pixels((columns.min() - half, columns.max() + half), (rows.min() - half, rows.max() + half), view)


def _before(near: float, corners: NDArray[np.float64], edges: NDArray[np.intp]) -> NDArray[np.float64]:
    """The corners of the part of a body with edges (E, 2) that is before the near plane."""
    one, other = corners[edges[:, 0]], corners[edges[:, 1]]
    cut = (one[:, 2] < near) != (other[:, 2] < near)
    one, other = one[cut], other[cut]
    share = (near - one[:, 2:]) / (other[:, 2:] - one[:, 2:])
    points = one + share * (other - one)
    # rounding of a huge box would put them elsewhere
    points[:, 2] = near
    return np.concatenate([corners[corners[:, 2] >= near], points])


def _pixels(columns: tuple[float, float], rows: tuple[float, float], view: View) -> tuple[int, int, int, int] | None:
    """The pixels between columns and rows, with those beside them; None for none."""
    (x0, x1), (y0, y1) = (
        (max(math.floor(low) - 1, 0), min(math.ceil(high) + 1, size))
        for (low, high), size in ((columns, view.width), (rows, view.height))
    )
    return (x0, y0, x1, y1) if x0 < x1 and y0 < y1 else None
