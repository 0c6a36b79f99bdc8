"""Images with lens distortion, sampled from undistorted images.

Undistorted images are rendered in up to six directions, and sampled at the directions of the pixels: colours from four
neighbours, depths from four neighbours on one plane, ids from the nearest neighbour. The near plane of a camera is that
of each of its undistorted images.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from morse.mathutils.portable import matmul
from morse.rendering.lens import MOST_PIXELS, Lens
from morse.rendering.light_codes import LIGHT, encoded

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray


#: number of pixels of undistorted images per pixel of the distorted image
_DENSITY = 1.25
#: one undistorted image is enough if no pixel is farther than 60 degrees from the axis
_ONE_IS_ENOUGH = 0.5
#: right, down, forward of the faces of a cube around the camera, in columns
_FACES = tuple(
    np.array(rows, np.float64).T
    for rows in (
        ((1, 0, 0), (0, 1, 0), (0, 0, 1)),
        ((0, 0, -1), (0, 1, 0), (1, 0, 0)),
        ((0, 0, 1), (0, 1, 0), (-1, 0, 0)),
        ((1, 0, 0), (0, 0, -1), (0, 1, 0)),
        ((1, 0, 0), (0, 0, 1), (0, -1, 0)),
        ((-1, 0, 0), (0, 1, 0), (0, 0, -1)),
    )
)
#: unit of positions, as a share of a pixel: rounding makes differences in the last bit irrelevant
_FRACTIONS = 256
#: maximum relative deviation of 1 / depth at the corners of a square on a plane from a linear function
_FLAT = np.float32(1e-3)


class Flat(NamedTuple):
    """One of the undistorted images.

    Attributes:
        lens: its lens.
        turn: (3, 3) its axes in the frame of the camera, in columns.
        pixels: (N,) indices of the pixels that are sampled from it.
        left, top: (N,) the upper left one of the four neighbours.
        across, down: (N,) float32, interpolation weights of the other neighbours, 0 to 1.
        nearest: (N,) index of the nearest neighbour.
        stretch: (N,) float32, factor from depths along its axis to depths along that of the camera; 0 if invalid.
    """

    lens: Lens
    turn: NDArray[np.float64]
    pixels: NDArray[np.intp]
    left: NDArray[np.intp]
    top: NDArray[np.intp]
    across: NDArray[np.float32]
    down: NDArray[np.float32]
    nearest: NDArray[np.intp]
    stretch: NDArray[np.float32]


class Drawn(NamedTuple):
    """The rendered undistorted image; see `morse.rendering.Picture`."""

    rgba: NDArray[np.uint8] | None
    depth: NDArray[np.float32]
    ids: NDArray[np.int32]
    normals: NDArray[np.float32] | None


class Warp:
    """The undistorted images for the image of a lens.

    Args:
        lens: a `morse.rendering.distortion.DistortedLens`.
        directions, shows: its ``directions``.

    Attributes:
        flats: one to six, or none if no pixel is valid.
    """

    def __init__(self, lens: Lens, directions: NDArray[np.float64], shows: NDArray[np.bool_]) -> None:
        self._lens = lens
        numbers = np.flatnonzero(shows)
        rays = directions.reshape(-1, 3)[numbers]
        if not len(rays) or rays[:, 2].min() > _ONE_IS_ENOUGH:
            face = np.zeros(len(rays), np.intp)
        else:
            face = np.stack([matmul(rays, turn[:, 2]) for turn in _FACES]).argmax(axis=0)
        self.flats = [
            _flat(lens, turn, numbers[face == n], rays[face == n]) for n, turn in enumerate(_FACES) if (face == n).any()
        ]

    def gather(self, images: Sequence[Drawn]) -> Drawn:
        """The distorted image from the undistorted ones."""
        size = self._lens.height * self._lens.width
        color = bool(images) and images[0].rgba is not None
        rgba = np.zeros((size, 4), np.uint8)
        rgba[:, 3] = 255
        depth, ids = np.zeros(size, np.float32), np.full(size, -1, np.int32)
        normals = np.zeros((size, 3), np.float32) if images and images[0].normals is not None else None
        for flat, picture in zip(self.flats, images, strict=True):
            if picture.rgba is not None:
                rgba[flat.pixels, :3] = _colors(flat, picture.rgba)
            numbers = picture.ids.ravel()[flat.nearest]
            if picture.normals is not None and normals is not None:
                # these rotations permute axes, so that the products are exact
                camera_normals = matmul(picture.normals.reshape(-1, 3)[flat.nearest], flat.turn.T.astype(np.float32))
                normals[flat.pixels] = camera_normals + np.float32(0)
            depths = _depths(flat, picture, numbers) * flat.stretch
            far = depths > np.float32(self._lens.far)
            ids[flat.pixels] = np.where(far, np.int32(-1), numbers)
            if normals is not None:
                normals[flat.pixels[far]] = 0
            depth[flat.pixels] = np.where(far | (numbers < 0), np.float32(0), depths)
        shape = (self._lens.height, self._lens.width)
        return Drawn(
            rgba.reshape(*shape, 4) if color else None,
            depth.reshape(shape),
            ids.reshape(shape),
            None if normals is None else normals.reshape(*shape, 3),
        )


def _flat(lens: Lens, turn: NDArray[np.float64], pixels: NDArray[np.intp], rays: NDArray[np.float64]) -> Flat:
    own = matmul(rays, turn)
    x, y = own[:, 0] / own[:, 2], own[:, 1] / own[:, 2]
    low, high = (x.min(), y.min()), (x.max(), y.max())
    f = _DENSITY * max(lens.fx, lens.fy)
    wide, tall = high[0] - low[0], high[1] - low[1]
    # an image limited to the maximum size is less sharp
    f = min(f, np.sqrt(MOST_PIXELS / 4 / max(wide * tall, 1e-12)), 4000 / max(wide, tall, 1e-9))
    # a margin of a pixel, so that all have four neighbours
    width, height = int(np.ceil(wide * f)) + 4, int(np.ceil(tall * f)) + 4
    cx, cy = 2.0 - low[0] * f, 2.0 - low[1] * f
    u, v = (np.floor((p * f + c - 0.5) * _FRACTIONS + 0.5) for p, c in ((x, cx), (y, cy)))
    left, top = np.floor(u / _FRACTIONS), np.floor(v / _FRACTIONS)
    across, down = u / _FRACTIONS - left, v / _FRACTIONS - top
    column, row = left.astype(np.intp), top.astype(np.intp)
    nearest = (row + (down >= 0.5)) * width + column + (across >= 0.5)
    stretch = np.where(rays[:, 2] > 1e-6, rays[:, 2] / own[:, 2], 0.0)
    return Flat(
        Lens(width, height, float(f), float(f), float(cx), float(cy), lens.near, lens.far),
        turn,
        pixels,
        column,
        row,
        across.astype(np.float32),
        down.astype(np.float32),
        nearest,
        stretch.astype(np.float32),
    )


def _neighbours(flat: Flat) -> list[tuple[NDArray[np.intp], NDArray[np.float32]]]:
    """The indices of the four neighbours, and their weights."""
    first, one = flat.top * flat.lens.width + flat.left, np.float32(1)
    return [
        (first, (one - flat.across) * (one - flat.down)),
        (first + 1, flat.across * (one - flat.down)),
        (first + flat.lens.width, (one - flat.across) * flat.down),
        (first + flat.lens.width + 1, flat.across * flat.down),
    ]


def _colors(flat: Flat, rgba: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """(N, 3) interpolated as linear light, not as sRGB codes."""
    pixels = rgba.reshape(-1, 4)[:, :3]
    light = np.zeros((len(flat.pixels), 3), np.float32)
    for at, share in _neighbours(flat):
        light += LIGHT[pixels[at]] * share[:, None]
    return encoded(light)


def _depths(flat: Flat, picture: Drawn, numbers: NDArray[np.int32]) -> NDArray[np.float32]:
    """(N,) 1 / depth is linear on a plane: interpolated if the neighbours are on one plane of one object."""
    depth, ids = picture.depth.ravel(), picture.ids.ravel()
    inverse, bend, same = np.zeros(len(numbers), np.float32), np.zeros(len(numbers), np.float32), numbers >= 0
    for (at, share), sign in zip(_neighbours(flat), (1, -1, -1, 1), strict=True):
        same &= ids[at] == numbers
        here = np.float32(1) / np.where(depth[at] > 0, depth[at], np.float32(1))
        inverse += share * here
        bend += np.float32(sign) * here
    same &= np.abs(bend) < _FLAT * inverse
    return np.where(same, np.float32(1) / np.where(same, inverse, np.float32(1)), depth[flat.nearest])
