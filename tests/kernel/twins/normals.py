"""The normals of visible surfaces; the twin of ``write_normals`` in ``c/draw_pixels.c`` and of ``c/draw_surface.h``."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from tests.kernel.twins.light import unit

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from morse.kernel.drawing.arrays import Drawing, Poses
    from tests.kernel.twins.project import Projected

    Floats = NDArray[np.float32]

_ONE = np.float32(1)


def normals(
    drawing: Drawing, camera: NDArray[np.void], poses: Poses, projected: Projected, visible: NDArray[np.int32]
) -> NDArray[np.float32]:
    """(N, 3) unit vectors in the axes of the camera, of pixels with the triangles ``visible``; 0 without a surface."""
    result = np.zeros((len(visible), 3), np.float32)
    solid = np.flatnonzero(visible >= 0)
    if not len(solid):
        return result
    width = int(camera["width"])
    x, y = ((at).astype(np.float32) + np.float32(0.5) for at in (solid % width, solid // width))
    n, r = unit(normals_at(drawing, poses, projected, visible[solid], x, y)), camera["axes"]
    for i in range(3):
        result[solid, i] = r[3 * i] * n[0] + r[3 * i + 1] * n[1] + r[3 * i + 2] * n[2]
    return result


def normals_at(
    d: Drawing, poses: Poses, projected: Projected, number: NDArray[np.int32], x: Floats, y: Floats
) -> list[Floats]:
    """Return the normals of triangles at samples, frame of the world, not normalised: three arrays (N,)."""
    turn = poses.turns[d.parts[projected.part[number], 1]]
    facing = np.where(projected.back[number], np.float32(-1), _ONE)
    e, n = projected.e[number], projected.vertices(d, number)["n"]
    rotated = [
        (turn[:, None, 3 * b] * n[..., 0] + turn[:, None, 3 * b + 1] * n[..., 1] + turn[:, None, 3 * b + 2] * n[..., 2])
        * facing[:, None]
        for b in range(3)
    ]
    planes = [[along(e, rotated[b], a) for a in range(3)] for b in range(3)]
    return [p[0] * x + p[1] * y + p[2] for p in planes]


def along(e: Floats, values: Floats, axis: int) -> Floats:
    """Return (N,) one coefficient of planes, from edges (N, 3, 3) and the values of the corners (N, 3)."""
    value: Floats = e[:, 0, axis] * values[:, 0] + e[:, 1, axis] * values[:, 1] + e[:, 2, axis] * values[:, 2]
    return value
