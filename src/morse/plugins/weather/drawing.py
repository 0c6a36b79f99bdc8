"""What the weather draws into pictures: streaks of drops, snow on the ground, water on it, and drops on the lens.

Light is in codes from 0 to 255, distances are in metres.
"""

from __future__ import annotations

import math
from functools import lru_cache
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from morse.plugins.weather.medium import falling_speed

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray

    from morse.plugins.weather.medium import Drops
    from morse.rendering import Lens, Picture

    Codes = NDArray[np.uint8]
    Floats = NDArray[np.float32]

#: colour of the light in fog, in codes: that of an overcast sky
SKY = (196.0, 200.0, 204.0)
#: m; drops that are farther than this are seen as haze, not as streaks
_NEAR, _FAR = 0.15, 1.5
#: mm; drops that are smaller than this leave no visible streak
_SMALLEST = 1.0
#: maximum number of streaks
_MOST = 3000
#: speeds of drops, m/s, by their diameters, mm
_DIAMETERS = np.linspace(0.0, 10.0, 101)
_SPEEDS = np.array([falling_speed(diameter) for diameter in _DIAMETERS.tolist()])
#: speed of flakes, m/s
_SPEED_OF_FLAKES = 1.2
#: smallest vertical components of the normal of a surface that snow and water stay on
SNOWY, LEVEL = 0.7, 0.95
#: the pattern of snow and puddles repeats after so many metres, in so many cells
_TILE, _CELLS = 16.0, 256
#: light of fresh snow in full light
_SNOW = 235.0
#: share of its light that a rough surface keeps when it is wet (S. Twomey, C. Bohren, J. Mergenthaler, Applied Optics
#: 25, 1986), and reflectance of water from above, of which Schlick's formula makes that of other angles
_DARK, _MIRROR = 0.6, 0.02
#: side of the squares of pixels that have one reflected ray
_SQUARE = 3
#: distances along a reflected ray at which it is compared with the picture, m
_STEPS = (0.15, 0.4, 0.8, 1.5, 2.5, 4.0, 6.5, 10.0, 16.0, 26.0, 42.0, 70.0)


def draw_streaks(
    rgba: Codes, drops: Drops, lens: Lens, exposure: float, random: np.random.Generator, *, flakes: bool
) -> None:
    """Draw the streaks of the drops in front of a camera."""
    height, width = rgba.shape[:2]
    volume = width * height / (lens.fx * lens.fy) * (_FAR**3 - _NEAR**3) / 3.0
    smallest = 0.0 if flakes else _SMALLEST
    count = min(int(random.poisson(min(drops.number(smallest) * volume, 1e6))), _MOST)
    if not count:
        return
    # evenly in the volume that the camera sees: the largest of three numbers is the cube root of one
    depth = np.maximum(_FAR * random.random((3, count)).max(axis=0), _NEAR)
    diameter = smallest + random.standard_exponential(count) / drops.slope
    speed = np.full(count, _SPEED_OF_FLAKES)
    if not flakes:
        speed = np.interp(diameter, _DIAMETERS, _SPEEDS)
    x, y = random.random(count) * width, random.random(count) * height
    length = np.maximum(speed * exposure * lens.fy / depth, 1.0)
    broad = 0.001 * diameter * lens.fx / depth
    # the share of the exposure, and of the pixel
    opacity = np.minimum(0.001 * diameter / (speed * exposure + 0.001 * diameter) * np.minimum(broad, 1.0), 1.0)
    visible = opacity > 1.0 / 255.0
    x, y, length, broad, opacity = (values[visible] for values in (x, y, length, broad, opacity))
    thick = np.clip(np.ceil(broad), 1, 24).astype(int)
    veil = np.zeros((height, width), np.float32)
    for left, top, tall, wide, strength in zip(
        x.astype(int).tolist(), y.astype(int).tolist(), length.astype(int).tolist(), thick.tolist(), opacity.tolist(),
        strict=True,
    ):  # fmt: skip
        part = veil[max(top - tall, 0) : top + 1, left : left + wide]
        np.maximum(part, strength, out=part)
    row, column = np.nonzero(veil)
    share = veil[row, column, None]
    pixels = rgba[row, column, :3]
    rgba[row, column, :3] = pixels + (np.array(SKY, np.float32) - pixels) * share


class Ground(NamedTuple):
    """The pixels of a picture that show flat ground.

    Attributes:
        pixel: (N,) their numbers.
        places: (3, N) in the world, m.
        ways: (3, N) from the camera to them, of length 1.
        share: (N,) places in the pattern of snow and puddles, evenly distributed from 0 to 1.
    """

    pixel: NDArray[np.intp]
    places: NDArray[np.floating]
    ways: NDArray[np.floating]
    share: Floats

    @classmethod
    def of(cls, picture: Picture, rays: Floats, flat: float) -> Ground:
        """Find the ground of a picture with normals.

        Args:
            picture: with depth and normals.
            rays: (H, W, 3) what `Lens.rays` returns.
            flat: smallest vertical component of its normals.
        """
        assert picture.normals is not None
        up = picture.axes[:, 2]
        normals = picture.normals
        rise = normals[..., 0] * up[0]
        rise += normals[..., 1] * up[1]
        rise += normals[..., 2] * up[2]
        # the normals of the sky are 0
        pixel = np.flatnonzero(rise > flat)
        x, y, z = rays.reshape(-1, 3).take(pixel, axis=0).T
        ways = np.stack([x * right + y * down + z * ahead for right, down, ahead in picture.axes.T])
        places = picture.eye[:, None] + ways * picture.depth.take(pixel)
        ways *= np.float32(1.0) / np.sqrt(x * x + y * y + z * z)
        cell = (places[:2] * np.float32(_CELLS / _TILE)).astype(np.int32) % _CELLS
        return cls(pixel, places, ways, _pattern().take(cell[0] * _CELLS + cell[1]))

    def snow(self, rgba: Codes, cover: float) -> None:
        """Cover a share of the ground with snow; its light is that of the ground, without its colours."""
        codes = _codes(rgba, self.pixel)
        # a soft border of the patches
        white = np.clip((np.float32(cover) - self.share) * np.float32(12.0) + np.float32(0.5), 0.0, 1.0)
        if cover >= 1.0:
            white[:] = 1.0
        brightest = np.maximum(np.maximum(codes[:, 0], codes[:, 1]), codes[:, 2])
        light = np.minimum(brightest * np.float32(0.45) + np.float32(0.55 * _SNOW), np.float32(255.0))
        _mix(rgba, self.pixel, codes, (light, light, light), white)

    def water(self, rgba: Codes, wet: float, picture: Picture, lens: Lens) -> None:
        """Darken wet ground, and let puddles reflect what the picture shows above them, else the sky."""
        deep = np.clip((np.float32(wet) - self.share) * np.float32(12.0) + np.float32(0.5), 0.0, 1.0)
        grazing = np.float32(1.0) - np.clip(-self.ways[2], np.float32(0.0), np.float32(1.0))
        fresnel = np.float32(_MIRROR) + np.float32(1.0 - _MIRROR) * grazing * grazing * grazing * grazing * grazing
        strength = fresnel * (np.float32(0.25 * wet) + np.float32(0.75) * deep)
        mirrored, number = self._reflected(rgba, picture, lens)
        # codes are about the square root of light
        darker = (np.arange(256) * (1.0 - (1.0 - math.sqrt(_DARK)) * wet)).astype(np.uint8)
        codes = darker.take(_codes(rgba, self.pixel))
        square = number.take(self._squares(self.pixel, rgba.shape[1]))
        _mix(rgba, self.pixel, codes, [mirrored[:, channel].take(square) for channel in range(3)], strength)

    @staticmethod
    def _squares(pixel: NDArray[np.intp], width: int) -> NDArray[np.intp]:
        """Return the numbers of the squares of pixels."""
        row, column = np.divmod(pixel, width)
        return np.asarray(row // _SQUARE * (width // _SQUARE + 1) + column // _SQUARE)

    def _reflected(self, rgba: Codes, picture: Picture, lens: Lens) -> tuple[Floats, NDArray[np.intp]]:
        """Return codes (K, 3) that reflected rays meet, and which of them each square of pixels shows."""
        height, width = picture.depth.shape
        row, column = np.divmod(self.pixel, width)
        is_sample = (row % _SQUARE == _SQUARE // 2) & (column % _SQUARE == _SQUARE // 2)
        places, ways = self.places[:, is_sample].astype(np.float64), self.ways[:, is_sample].astype(np.float64)
        ways[2] = -ways[2]
        found = np.empty((places.shape[1] + 1, 3), np.float32)
        found[:] = SKY
        left = np.arange(places.shape[1])
        axes, eye = picture.axes.astype(np.float64), picture.eye.astype(np.float64)
        for step in _STEPS:
            there = places[:, left] + ways[:, left] * step - eye[:, None]
            seen = np.stack([x * there[0] + y * there[1] + z * there[2] for x, y, z in axes.tolist()], axis=1)
            spot = lens.project(seen)
            inside = (spot[:, 0] >= 0) & (spot[:, 0] < width) & (spot[:, 1] >= 0) & (spot[:, 1] < height)
            # rays that leave the picture show the sky
            left, seen, spot = left[inside], seen[inside], spot[inside].astype(np.intp)
            depth = picture.depth[spot[:, 1], spot[:, 0]]
            is_behind = (depth > 0.0) & (depth < seen[:, 2])
            found[left[is_behind]] = rgba[spot[is_behind, 1], spot[is_behind, 0], :3]
            left = left[~is_behind]
            if not len(left):
                break
        # the last one is the sky
        number = np.full((height // _SQUARE + 1) * (width // _SQUARE + 1), len(found) - 1)
        number[self._squares(self.pixel[is_sample], width)] = np.arange(places.shape[1])
        return found, number


def _codes(rgba: Codes, pixel: NDArray[np.intp]) -> Codes:
    """Return the codes (N, 4) of pixels of a contiguous picture."""
    return rgba.view(np.uint32).ravel().take(pixel).view(np.uint8).reshape(-1, 4)


def _mix(
    rgba: Codes, pixel: NDArray[np.intp], codes: Codes, others: Sequence[Floats], share: NDArray[np.floating]
) -> None:
    """Set pixels (N,) to a mixture of codes (N, 4) and, by a share (N,), of others, (N,) for each channel."""
    mixed = codes.copy()
    for channel, other in enumerate(others):
        code = codes[:, channel].astype(np.float32)
        code += (other - code) * share
        mixed[:, channel] = code
    rgba.view(np.uint32).reshape(-1)[pixel] = mixed.view(np.uint32).ravel()


@lru_cache(1)
def _pattern() -> Floats:
    """Return smooth numbers (256, 256), evenly distributed from 0 to 1, that continue at the opposite borders."""
    random = np.random.Generator(np.random.PCG64(5))
    total = np.zeros((_CELLS, _CELLS))
    for width, weight in ((48, 1.0), (12, 0.35), (3, 0.12)):
        smooth = random.random((_CELLS, _CELLS))
        for axis in (0, 1, 0, 1):
            runs = np.cumsum(np.concatenate([smooth, np.take(smooth, range(width), axis=axis)], axis=axis), axis=axis)
            after = np.take(runs, range(width, _CELLS + width), axis=axis)
            smooth = after - np.take(runs, range(_CELLS), axis=axis)
        total += weight * (smooth - smooth.mean()) / smooth.std()
    ranks = np.empty(_CELLS * _CELLS, np.float32)
    ranks[np.argsort(total, axis=None, kind="stable")] = np.arange(_CELLS * _CELLS, dtype=np.float32)
    return (ranks / np.float32(_CELLS * _CELLS)).reshape(_CELLS, _CELLS)


def draw_lens_drops(
    rgba: Codes, mean: float, time: float, random_of: Callable[[int, int], np.random.Generator]
) -> None:
    """Draw the drops on a lens: out of focus, each shows the scene turned over.

    Args:
        rgba: the picture.
        mean: number of drops.
        time: s.
        random_of: returns the generator of a place on the lens and of the drop in turn there.
    """
    height, width = rgba.shape[:2]
    small = rgba[:: max(height // 48, 1), :: max(width // 64, 1), :3].astype(np.float32)
    # each place has a drop for half of the time
    for place in range(math.ceil(2.0 * mean)):
        chosen = random_of(place, -1)
        period, start = 4.0 + 8.0 * chosen.random(), chosen.random()
        turn, age = divmod(time / period + start, 1.0)
        drop = random_of(place, int(turn))
        present = 0.5 * min(2.0 * mean - place, 1.0)
        x, y, radius = drop.random() * width, drop.random() * height, (0.015 + 0.045 * drop.random() ** 2) * height
        if age < present:
            # large ones run down
            y += 2.0 * radius * age * (radius > 0.04 * height) / present
            _refract(rgba, small, x, y, radius)


def _refract(rgba: Codes, small: Floats, x: float, y: float, radius: float) -> None:
    height, width = rgba.shape[:2]
    top, bottom = max(int(y - radius), 0), min(int(y + radius) + 1, height)
    left, right = max(int(x - radius), 0), min(int(x + radius) + 1, width)
    if top >= bottom or left >= right:
        return
    down = (np.arange(top, bottom, dtype=np.float32)[:, None] + np.float32(0.5 - y)) / np.float32(radius)
    across = (np.arange(left, right, dtype=np.float32)[None, :] + np.float32(0.5 - x)) / np.float32(radius)
    square = down * down + across * across
    share = np.clip((np.float32(1.0) - square) * np.float32(2.5), 0.0, np.float32(0.9))[..., None]
    # a ball lens turns a wide field over
    row = np.clip((0.5 - 0.5 * down + 0.0 * across) * small.shape[0], 0, small.shape[0] - 1).astype(np.intp)
    column = np.clip((0.5 - 0.5 * across + 0.0 * down) * small.shape[1], 0, small.shape[1] - 1).astype(np.intp)
    part = rgba[top:bottom, left:right, :3]
    part[...] = part + (small[row, column] * np.float32(0.92) - part) * share
