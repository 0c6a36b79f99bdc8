"""What the weather draws into pictures: streaks of drops, and drops on the lens.

Light is in codes from 0 to 255, distances are in metres.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from morse.plugins.weather.medium import falling_speed

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from morse.plugins.weather.medium import Conditions, Drops
    from morse.rendering import Lens

    Codes = NDArray[np.uint8]
    Floats = NDArray[np.float32]

#: colour of the light in fog, in codes: that of an overcast sky
SKY = (196.0, 200.0, 204.0)
#: share of the codes of the sky that rain clouds take at most, and the rate at which they take 63 % of it, mm/h: our
#: choice
_DARKEST, _DARK_RAIN = 0.35, 10.0
#: codes between the colours of two skies
_SHADES = 4
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


def sky_in(conditions: Conditions) -> tuple[int, int, int]:
    """Return the codes of the light in the air: the more it rains, the darker are the clouds."""
    share = 1.0 - _DARKEST * (1.0 - math.exp(-conditions.rain / _DARK_RAIN))
    red, green, blue = (int(code) if share == 1.0 else round(code * share / _SHADES) * _SHADES for code in SKY)
    return red, green, blue


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
