"""Snow and water on the ground of pictures.

Pixels are numbers of 32 bits: red, green, blue and a fourth byte, the red one lowest. Two bytes at a time are
multiplied by weights and added, in the lower and the upper half of a number. Distances are in metres.
"""

from __future__ import annotations

import math
from functools import lru_cache
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from morse.plugins.weather.drawing import SKY

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from morse.rendering import Lens, Picture

    Codes = NDArray[np.uint8]
    Floats = NDArray[np.float32]
    Packed = NDArray[np.uint32]

#: smallest vertical components of the normal of a surface that snow and water stay on
SNOWY, LEVEL = 0.7, 0.95
#: the pattern of snow and puddles repeats after so many metres, in so many cells, which are computed from larger ones
_TILE, _CELLS, _LARGE = 16.0, 1024, 4
#: steps of the share at the border of a patch, whose light changes gradually
_BORDER = 12.0
#: light of fresh snow in full light, in codes, and how much of the light of the ground is left below it
_SNOW, _BELOW = 235.0, 0.45
#: share of its light that a rough surface keeps when it is wet (S. Twomey, C. Bohren, J. Mergenthaler, Applied Optics
#: 25, 1986), and reflectance of water from above, of which Schlick's formula makes that of other angles
DARK, _MIRROR = 0.6, 0.02
#: pixels between those that have a reflected ray; the others lie between these
_EACH = 4
#: distances along a reflected ray at which it is compared with the picture, m, and how thick a surface is at least
_STEPS = (0.15, 0.4, 0.8, 1.5, 2.5, 4.0, 6.5, 10.0, 16.0, 26.0, 42.0, 70.0)
_THICK = 0.3
#: the lower byte of each half, and the upper one
_LOW, _HIGH = np.uint32(0x00FF00FF), np.uint32(0xFF00FF00)
_OPAQUE = np.uint32(0xFF000000)


class Ground(NamedTuple):
    """The pixels of a picture that show flat ground.

    Attributes:
        picture: with depth and normals.
        rays: right and down (H, W), of what `Lens.rays` returns.
        is_ground: (H, W).
        pixel: (N,) their numbers.
        cell: (N,) their places in the pattern of snow and puddles.
    """

    picture: Picture
    rays: tuple[Floats, Floats]
    is_ground: NDArray[np.bool_]
    pixel: NDArray[np.intp]
    cell: NDArray[np.int32]

    @classmethod
    def of(cls, picture: Picture, rays: tuple[Floats, Floats], flat: float) -> Ground:
        """Find the ground of a picture; ``flat`` is the smallest vertical component of its normals."""
        assert picture.normals is not None
        up = picture.axes[:, 2]
        normals = picture.normals
        rise = normals[..., 0] * up[0]
        rise += normals[..., 1] * up[1]
        rise += normals[..., 2] * up[2]
        # the normals of the sky are 0
        is_level = rise > flat
        # pixels at a border show something else as well
        is_ground = is_level.copy()
        is_ground[1:] &= is_level[:-1]
        is_ground[:-1] &= is_level[1:]
        pixel = np.flatnonzero(is_ground)
        x, y, depth = (plane.ravel().take(pixel) for plane in (*rays, picture.depth))
        scale = np.float32(_CELLS / _TILE)
        cell = np.zeros(len(pixel), np.int32)
        for axis, size in ((0, _CELLS), (1, 1)):
            right, down, ahead = picture.axes[:, axis] * scale
            place = np.floor((x * right + y * down + ahead) * depth + picture.eye[axis] * scale)
            cell += (place.astype(np.int32) & (_CELLS - 1)) * np.int32(size)
        return cls(picture, rays, is_ground, pixel, cell)

    def snow(self, rgba: Codes, cover: float) -> None:
        """Cover a share of the ground with snow; its light is that of the ground, without its colours."""
        codes = rgba.view(np.uint32).ravel().take(self.pixel)
        brightest = np.maximum(np.maximum(codes & 0xFF, codes >> 8 & 0xFF), codes >> 16 & 0xFF)
        # at most 244
        light = (brightest * np.uint32(256 * _BELOW) + np.uint32(256 * (1.0 - _BELOW) * _SNOW)) >> 8
        weight = _patches(cover).take(self.cell).astype(np.uint32)
        weight += weight >> 7
        _mix(rgba, self.pixel, codes, np.uint32(256) - weight, light * np.uint32(0x010101), weight)

    def water(self, rgba: Codes, wet: float, lens: Lens) -> None:
        """Darken wet ground, and let puddles reflect what the picture shows above them, else the sky."""
        if not len(self.pixel):
            return
        width = rgba.shape[1]
        first = int(self.pixel[0]) // (width * _EACH) * _EACH
        last = int(self.pixel[-1]) // width
        light = _enlarged(self._reflected(rgba, lens, first, last), last + 1 - first, width)
        light = light.take(self.pixel - first * width)
        # film and puddles
        share = _patches(wet).take(self.cell) * np.float32(0.75 / 255.0) + np.float32(0.25 * wet)
        weight = ((light >> 24) * share).astype(np.uint32)
        codes = rgba.view(np.uint32).ravel().take(self.pixel)
        # codes are about the square root of light
        dark = np.uint32(round(256 * (1.0 - (1.0 - math.sqrt(DARK)) * wet)))
        _mix(rgba, self.pixel, codes, (np.uint32(256) - weight) * dark >> 8, light, weight)

    def _reflected(self, rgba: Codes, lens: Lens, first: int, last: int) -> Packed:
        """Return what water reflects in each `_EACH`th pixel of some rows; the fourth byte is the reflectance."""
        picture = self.picture
        height, width = picture.depth.shape
        # the middles of squares of pixels
        rows, columns = (
            np.minimum(np.arange(begin, end, _EACH) + _EACH // 2, size - 1)
            for begin, end, size in ((first, last + 1, height), (0, width, width))
        )
        square = rows[:, None] * width + columns
        is_here = self.is_ground.ravel()[square]
        pixel = square[is_here]
        x, y, depth = (plane.ravel().take(pixel) for plane in (*self.rays, picture.depth))
        longer = np.float32(1.0) / np.sqrt(x * x + y * y + np.float32(1.0))
        assert picture.normals is not None
        right, down, ahead = picture.normals.reshape(-1, 3).take(pixel, axis=0).T
        cosine = -(x * right + y * down + ahead) * longer
        # in the axes of the camera
        way = [
            part * longer + np.float32(2.0) * normal * cosine for part, normal in ((x, right), (y, down), (1.0, ahead))
        ]
        start = [x * depth, y * depth, depth]
        found = np.full(len(pixel), _packed(SKY), np.uint32)
        left = np.arange(len(pixel))
        codes, depths, before = rgba.view(np.uint32).ravel(), picture.depth.ravel(), 0.0
        for step in _STEPS:
            seen = [part + turn * np.float32(step) for part, turn in zip(start, way, strict=True)]
            far = np.maximum(seen[2], np.float32(1e-6))
            flat = lens.bend(np.stack([seen[0] / far, seen[1] / far], axis=1))
            # limited as numbers, because those of rays that point away are huge
            column = np.clip(flat[:, 0] * lens.fx + lens.cx, -1.0, width).astype(np.int32)
            row = np.clip(flat[:, 1] * lens.fy + lens.cy, -1.0, height).astype(np.int32)
            inner_row, inner = np.clip(row, 0, height - 1), np.clip(column, 0, width - 1)
            spot = inner_row * width + inner
            there = depths.take(spot)
            is_in = (inner == column) & (inner_row == row) & (seen[2] > 1e-6)
            thick = np.float32(step - before + _THICK)
            is_met = is_in & (there > 0.0) & (there < far) & (there > far - thick)
            # a ray that leaves the picture, or has not met anything, shows the sky next to it
            is_sky = (~is_in | (step == _STEPS[-1])) & (there <= 0.0) & (seen[2] > 1e-6)
            is_shown = is_met | is_sky
            found[left[is_shown]] = codes.take(spot[is_shown])
            goes_on = is_in & ~is_met
            left = left[goes_on]
            if not len(left):
                break
            start, way = [part[goes_on] for part in start], [part[goes_on] for part in way]
            before = step
        grazing = np.float32(1.0) - np.clip(cosine, np.float32(0.0), np.float32(1.0))
        square_of = grazing * grazing
        fresnel = np.float32(_MIRROR) + np.float32(1.0 - _MIRROR) * square_of * square_of * grazing
        reflected = np.zeros(square.shape, np.uint32)
        strength = np.maximum(fresnel * np.float32(255.0), np.float32(1.0)).astype(np.uint32)
        reflected[is_here] = (found & ~_OPAQUE) | strength << 24
        return _filled(_filled(reflected).T).T


def _packed(color: tuple[float, float, float]) -> np.uint32:
    red, green, blue = (int(part) for part in color)
    return np.uint32(red | green << 8 | blue << 16)


def _mix(rgba: Codes, pixel: NDArray[np.intp], codes: Packed, keep: Packed, others: Packed, weight: Packed) -> None:
    """Set pixels (N,) to a sum of codes and others, with weights of which the sum is at most 256."""
    low = ((codes & _LOW) * keep + (others & _LOW) * weight) >> 8 & _LOW
    middle = (codes >> 8 & 0xFF) * keep + (others >> 8 & 0xFF) * weight & 0xFF00
    rgba.view(np.uint32).reshape(-1)[pixel] = low | middle | _OPAQUE


def _filled(codes: Packed) -> Packed:
    """Return codes (H, W) in which zeros have the value of the nearest other number above, or else below."""
    numbers = np.arange(len(codes))[:, None]
    is_there = codes != 0
    above = np.maximum.accumulate(np.where(is_there, numbers, -1), axis=0)
    below = np.minimum.accumulate(np.where(is_there, numbers, len(codes))[::-1], axis=0)[::-1]
    row = np.where(above >= 0, above, np.minimum(below, len(codes) - 1))
    return np.asarray(np.take_along_axis(codes, row, axis=0))


def _enlarged(codes: Packed, height: int, width: int) -> Packed:
    """Return numbers (height * width,) between those of each `_EACH`th pixel, linear in each byte."""
    halves: list[Packed] = []
    for half in (codes & _LOW, codes >> 8 & _LOW):
        wide = _between(np.ascontiguousarray(half.T), width)
        # the sums of four numbers fit into half of the bits, those of sixteen as well
        halves.append(_between(np.ascontiguousarray(wide.T), height))
    whole: Packed = (halves[0] >> np.uint32(4) & _LOW) | (halves[1] << np.uint32(4) & _HIGH)
    return whole.ravel()


def _between(rows: Packed, size: int) -> Packed:
    """Return rows (size, W), `_EACH` times those between the middles of squares."""
    framed = np.concatenate([rows[:1], rows, rows[-1:]])
    change = framed[1:] - framed[:-1]
    result = np.empty((len(change), _EACH, rows.shape[1]), np.uint32)
    total: Packed = framed[:-1] * np.uint32(_EACH)
    for step in range(_EACH):
        result[:, step] = total
        total += change
    return np.asarray(result.reshape(-1, rows.shape[1])[_EACH // 2 :][:size])


@lru_cache(4)
def _patches(share: float) -> Codes:
    """Return how much of each cell of the pattern is covered (N,), 0 to 255, if a share of the ground is."""
    if share >= 1.0:
        return np.full(_CELLS * _CELLS, 255, np.uint8)
    covered = np.clip((np.float32(share) - _pattern()) * np.float32(_BORDER) + np.float32(0.5), 0.0, 1.0)
    return np.asarray((covered.ravel() * np.float32(255.0)).astype(np.uint8))


@lru_cache(1)
def _pattern() -> Floats:
    """Return smooth numbers, evenly distributed from 0 to 1, that continue at the opposite borders."""
    random = np.random.Generator(np.random.PCG64(5))
    count = _CELLS // _LARGE
    total = np.zeros((count, count))
    for width, weight in ((48, 1.0), (12, 0.35), (3, 0.12)):
        smooth = random.random((count, count))
        for axis in (0, 1, 0, 1):
            runs = np.cumsum(np.concatenate([smooth, np.take(smooth, range(width), axis=axis)], axis=axis), axis=axis)
            after = np.take(runs, range(width, count + width), axis=axis)
            smooth = after - np.take(runs, range(count), axis=axis)
        total += weight * (smooth - smooth.mean()) / smooth.std()
    ranks = np.empty(count * count, np.float32)
    ranks[np.argsort(total, axis=None, kind="stable")] = np.arange(count * count, dtype=np.float32)
    numbers = (ranks / np.float32(count * count)).reshape(count, count)
    for axis in (0, 1):
        after = np.roll(numbers, -1, axis=axis)
        parts = [numbers + (after - numbers) * np.float32(step / _LARGE) for step in range(_LARGE)]
        shape = [_CELLS if one == axis else size for one, size in enumerate(numbers.shape)]
        numbers = np.stack(parts, axis=axis + 1).reshape(shape)
    return numbers
