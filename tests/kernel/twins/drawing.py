"""Images rendered by numpy, triangle by triangle: the reference for the C functions, which are bit-identical."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from morse.kernel.drawing.arrays import DITHERED, MASKED, SAMPLES, TILE, Pictures, number_tiles
from tests.kernel.twins import colors, normals, shadows
from tests.kernel.twins.project import Projected, project

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from morse.kernel.drawing.arrays import Drawing, Light, Poses
    from morse.kernel.drawing.native import Kept

_BAYER = np.array([[0, 8, 2, 10], [12, 4, 14, 6], [3, 11, 1, 9], [15, 7, 13, 5]], np.float32)
_FARTHEST_TEXEL = 8e6
_LANES = 8


class ReferenceDrawer:
    """Renders images; the twin of `morse.kernel.drawing.native.NativeDrawer`.

    Attributes:
        drawing: the scene.
        drawn_tiles: number of tiles of the last images; see `morse.kernel.drawing.native.NativeDrawer`.
    """

    def __init__(self, drawing: Drawing) -> None:
        self.drawing = drawing
        self.drawn_tiles = 0

    def draw(
        self, cameras: NDArray[np.void], poses: Poses, light: Light, samples: int, memories: Sequence[Kept | None] = ()
    ) -> Pictures:
        """The images of cameras (K,) `CAMERA`; nothing is kept."""
        self.drawn_tiles, _ = number_tiles(cameras)
        with np.errstate(all="ignore"):
            images = [self._draw(camera, poses, light, samples) for camera in cameras]
        no_pixels = np.zeros(0, np.float32)
        empty = Pictures(np.zeros((0, 4), np.uint8), no_pixels, np.zeros(0, np.int32), no_pixels.reshape(0, 3))
        return Pictures(*(np.concatenate(column) for column in zip(empty, *images, strict=True)))

    def cast_shadows(self, parts: NDArray[np.integer], poses: Poses, light: Light) -> NDArray[np.int32]:
        """Draw parts into the shadow map; returns the texels (N, 4) that each part may have filled."""
        with np.errstate(all="ignore"):
            return shadows.cast(self.drawing, parts, poses, light)

    def bound_shadows(self, light: Light) -> None:
        """Do nothing: bounds only save time, and this drawer always reads the texels."""

    def moving_shadows(self, parts: NDArray[np.integer], light: Light) -> shadows.ReferenceMovers:
        """Return the shadows of parts that may move, in a map that has the shadows of the others already."""
        return shadows.ReferenceMovers(self.drawing, parts, light)

    def _draw(self, camera: NDArray[np.void], poses: Poses, light: Light, samples: int) -> Pictures:
        count = samples if camera["color"] else 1
        projected = project(self.drawing, camera, poses, count)
        shape = (count, int(camera["height"]), int(camera["width"]))
        inverse = np.full(shape, np.float32(1) / camera["far"], np.float32)
        visible = np.full(shape, -1, np.int32)
        for number in range(len(projected)):
            self._cover(camera, projected, number, samples, inverse, visible)
        who = visible[0].ravel()
        instances = self.drawing.parts[projected.part, 1] if len(projected) else np.zeros(1, np.int32)
        ids = np.where(who < 0, np.int32(-1), instances[np.maximum(who, 0)])
        depth = np.where(who < 0, np.float32(0), np.float32(1) / inverse[0].ravel())
        rgba = np.zeros((len(who), 4), np.uint8)
        if camera["color"]:
            rgba = colors.paint(self.drawing, camera, poses, light, projected, visible.reshape(count, -1))
        facing = np.zeros((len(who), 3), np.float32)
        if camera["normals"]:
            facing = normals.normals(self.drawing, camera, poses, projected, who)
        return Pictures(rgba, depth.astype(np.float32), ids.astype(np.int32), facing)

    def _cover(
        self,
        camera: NDArray[np.void],
        projected: Projected,
        number: int,
        samples: int,
        inverse: NDArray[np.float32],
        visible: NDArray[np.int32],
    ) -> None:
        """Write a triangle into the samples where it is the nearest."""
        x0, y0, x1, y1 = projected.box[number].tolist()
        columns, rows = np.arange(x0, x1 + 1), np.arange(y0, y1 + 1)
        e, w = projected.e[number], projected.w[number]
        tiles = _tiles(projected.box[number], e, columns, rows)
        holes = self.drawing.materials[projected.material[number]]["flags"] & (MASKED | DITHERED)
        nearest = np.float32(1) / camera["near"]
        for sample in range(len(inverse)):
            shift = np.array(SAMPLES[samples][sample], np.float32)
            fx = (columns.astype(np.float32) // _LANES * _LANES + np.float32(0.5) + shift[0]) + (
                columns % _LANES
            ).astype(np.float32)
            fy = rows.astype(np.float32) + np.float32(0.5) + shift[1]
            at, who = inverse[sample, y0 : y1 + 1, x0 : x1 + 1], visible[sample, y0 : y1 + 1, x0 : x1 + 1]
            plane = [e[i, 0] * fx[None] + (e[i, 1] * fy + e[i, 2])[:, None] for i in range(3)]
            depth = w[0] * fx[None] + (w[1] * fy + w[2])[:, None]
            inside = (plane[0] >= 0) & (plane[1] >= 0) & (plane[2] >= 0) & (depth > at) & (depth < nearest) & tiles
            if holes and inside.any():
                inside &= self._opaque(projected, number, fx, fy, columns + sample, rows + 2 * sample)
            at[inside], who[inside] = depth[inside], number

    def _opaque(
        self,
        projected: Projected,
        number: int,
        fx: NDArray[np.float32],
        fy: NDArray[np.float32],
        columns: NDArray[np.integer],
        rows: NDArray[np.integer],
    ) -> NDArray[np.bool_]:
        """Where a surface has no holes, and is not translucent."""
        d = self.drawing
        material = d.materials[projected.material[number]]
        limit = (_BAYER[rows & 3][:, columns & 3] + np.float32(0.5)) / np.float32(16)
        opaque = np.asarray(material["color"][3] > limit)
        if material["texture"] < 0:
            return opaque
        texture = d.textures[material["texture"]]
        e = projected.e[number]
        x, y = np.broadcast_arrays(fx[None], fy[:, None])
        weights = [e[i, 0] * x + e[i, 1] * y + e[i, 2] for i in range(3)]
        uv = projected.vertices(d, np.array([number]))["uv"][0]
        whole = weights[0] + weights[1] + weights[2]
        at = []
        for axis, size in ((0, texture["width"]), (1, texture["height"])):
            place = (weights[0] * uv[0, axis] + weights[1] * uv[1, axis] + weights[2] * uv[2, axis]) / whole
            texel = np.floor(place * np.float32(size))
            fine = (texel > -_FARTHEST_TEXEL) & (texel < _FARTHEST_TEXEL)
            at.append(np.where(fine, texel, 0).astype(np.int64) & (int(size) - 1))
        alpha = d.texels[texture["first"][0] + at[1] * (texture["width"] + 1) + at[0]].view(np.uint32) >> 30
        return np.asarray(opaque & (alpha >= 2))


def _tiles(
    box: NDArray[np.integer], e: NDArray[np.float32], columns: NDArray[np.integer], rows: NDArray[np.integer]
) -> NDArray[np.bool_]:
    """The pixels of columns and rows in tiles that a triangle may touch."""
    across, down = columns // TILE, rows // TILE
    x0, y0, x1, y1 = (box // TILE).tolist()
    if x1 - x0 + y1 - y0 <= 1:
        return np.ones((len(rows), len(columns)), bool)
    x, y = (across * TILE).astype(np.float32)[None], (down * TILE).astype(np.float32)[:, None]
    free = np.zeros((len(rows), len(columns)), bool)
    for i in range(3):
        far_x = x + np.float32(TILE) if e[i, 0] > 0 else x
        far_y = y + np.float32(TILE) if e[i, 1] > 0 else y
        free |= e[i, 0] * far_x + e[i, 1] * far_y + e[i, 2] < 0
    return ~free
