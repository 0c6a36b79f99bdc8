"""Pixels that report changes of the light, of event cameras of scenes and of models of MuJoCo."""

from __future__ import annotations

import math
from functools import cache
from typing import TYPE_CHECKING

import numpy as np

from morse.mathutils.portable import linear_light

if TYPE_CHECKING:
    from numpy.typing import NDArray

#: units of the integers that stand for the light: white is 2^18 - 1
_WHITE = 262143
#: light of a pixel that is black, as a share of white: dark current
_DARK = 0.002
#: most events of a pixel between two images, and of a measurement
_MOST_OF_A_PIXEL, MOST_EVENTS = 64, 100_000
#: the least threshold of a pixel
_LEAST = np.float32(0.01)


@cache
def _tables() -> tuple[NDArray[np.uint32], NDArray[np.float32]]:
    """The light (3, 256) of the codes of red, green and blue, and the logarithm of each light."""
    light = linear_light(np.arange(256) / 255.0)
    weights = (0.2126, 0.7152, 0.0722)  # ITU-R BT.709
    parts = np.array([np.rint(light * weight * _WHITE) for weight in weights]).astype(np.uint32)
    logarithms = [math.log(value / _WHITE + _DARK) for value in range(_WHITE + 3)]
    return parts, np.array(logarithms, dtype=np.float32)


def log_light(rgba: NDArray[np.uint8]) -> NDArray[np.float32]:
    """Return the natural logarithm (H, W) of the luminance of an image (H, W, 3 or 4) in sRGB, white 1."""
    parts, logarithms = _tables()
    return np.asarray(logarithms[parts[0][rgba[..., 0]] + parts[1][rgba[..., 1]] + parts[2][rgba[..., 2]]])


class EventPixels:
    """Pixels that remember the logarithm of their light, by the model of ESIM (CoRL 2018).

    Attributes:
        memory: (H, W) float32, the logarithm that each pixel remembers.
        last: (H, W) float32, that of the last image.
        fired: (H, W) s, time of the last event of each pixel.
    """

    def __init__(self, memory: NDArray[np.float32], last: NDArray[np.float32], fired: NDArray[np.float64]) -> None:
        self.memory, self.last, self.fired = memory, last, fired

    @classmethod
    def at_rest(cls, now: NDArray[np.float32]) -> EventPixels:
        """Return pixels that remember an image."""
        return cls(now.copy(), now, np.full(now.shape, -math.inf))

    def events(
        self, now: NDArray[np.float32], limit: NDArray[np.float32], refractory: float, begin: float, end: float
    ) -> NDArray[np.float64]:
        """Return the events (n, 4) between the last image and another one, not ordered.

        Args:
            now: (H, W) logarithm of the light in the new image.
            limit: (H, W) thresholds.
            refractory: s, for which a pixel is blind after an event.
            begin, end: s, times of the images.

        Returns:
            Column and row from the upper left corner, time (s), polarity (1: brighter, -1: darker).
        """
        change = now - self.memory
        rows, columns = np.nonzero(np.abs(change) > limit * np.float32(0.9999))
        counts = np.floor(np.abs(change[rows, columns]) / limit[rows, columns] + np.float32(2e-4)).astype(np.int64)
        blocks = [np.zeros((0, 4))]
        if len(rows):
            number = np.minimum(counts, _MOST_OF_A_PIXEL)
            step = limit[rows, columns].astype(np.float64)
            sign = np.sign(change[rows, columns]).astype(np.float64)
            start, memory = self.last[rows, columns].astype(np.float64), self.memory[rows, columns].astype(np.float64)
            slope = now[rows, columns] - start
            free = self.fired[rows, columns] + refractory
            for index in range(int(number.max())):
                level = memory + sign * step * (index + 1)
                share = np.divide(level - start, slope, out=np.ones_like(level), where=slope != 0.0)
                times = begin + np.clip(share, 0.0, 1.0) * (end - begin)
                good = (index < number) & (times >= free)
                free = np.where(good, times + refractory, free)
                blocks.append(np.column_stack([columns, rows, times, sign])[good])
            self.fired[rows, columns] = free - refractory
            self.memory[rows, columns] += (sign * step * counts).astype(np.float32)
        self.last = now
        return np.concatenate(blocks)


def thresholds(
    shape: tuple[int, ...], threshold: float, deviation: float, random: np.random.Generator | None
) -> NDArray[np.float32]:
    """Return the thresholds (H, W) of pixels, which differ if there is a generator."""
    limits = np.full(shape, threshold, np.float32)
    if random is not None:
        limits += random.standard_normal(shape, np.float32) * np.float32(deviation)
    return np.maximum(limits, _LEAST)


def noise_events(
    random: np.random.Generator, rate: float, shape: tuple[int, ...], begin: float, end: float
) -> NDArray[np.float64]:
    """Return events (n, 4) without a reason; they are as many as a Poisson process of all pixels has.

    Args:
        rate: of each pixel, Hz.
    """
    count = min(int(random.poisson(min(rate * (end - begin) * shape[0] * shape[1], 1e6))), MOST_EVENTS)
    columns, rows = random.integers(0, shape[1], count), random.integers(0, shape[0], count)
    times = begin + random.random(count) * (end - begin)
    return np.column_stack([columns, rows, times, random.integers(0, 2, count) * 2.0 - 1.0])


def by_time(events: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return events (n, 4) by time, row and column."""
    return events[np.lexsort((events[:, 0], events[:, 1], events[:, 2]))]
