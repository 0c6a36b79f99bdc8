"""Textures as arrays (H, W, 3), sRGB 0..1; all of them tile without a seam unless stated otherwise."""

from __future__ import annotations

import numpy as np

from common.colors import srgb


def noise(size: int, grain: float, seed: int, stretch: float = 1.0) -> np.ndarray:
    """Smooth periodic noise (size, size), mean 0, standard deviation 1.

    Args:
        grain: number of spots across the image, from top to bottom.
        stretch: ratio of length to height of the spots.
    """
    white = np.random.default_rng(seed).normal(size=(size, size))
    fy, fx = np.meshgrid(np.fft.fftfreq(size) * size, np.fft.fftfreq(size) * size, indexing="ij")
    spectrum = np.fft.fft2(white) * np.exp(-((fx * stretch) ** 2 + fy**2) / (2 * grain**2))
    spectrum[0, 0] = 0.0
    field = np.fft.ifft2(spectrum).real
    return field / field.std()


def blend(low: str, high: str, share: np.ndarray) -> np.ndarray:
    """Mix two colours; ``share`` (H, W) is 0 for the first and 1 for the second."""
    return srgb(low) + (srgb(high) - srgb(low)) * np.clip(share, 0.0, 1.0)[..., None]


def wood(size: int, dark: str, light: str, seed: int) -> np.ndarray:
    """Grain along u, with year rings and pores."""
    warp = noise(size, 2.0, seed, stretch=3.0)
    height = np.arange(size)[:, None] / size
    rings = 0.5 + 0.5 * np.sin(2 * np.pi * (7 * height + 0.5 * warp))
    streaks = noise(size, 60.0, seed + 1, stretch=22.0)
    pores = noise(size, 130.0, seed + 2, stretch=9.0)
    return blend(dark, light, 0.55 + 0.28 * (rings - 0.5) + 0.12 * streaks + 0.05 * pores)


def planks(size: int, dark: str, light: str, boards: int, seed: int) -> np.ndarray:
    """Boards along u, one above the other, with dark joints."""
    rows = np.arange(size)
    board = rows * boards // size
    random = np.random.default_rng(seed)
    grain = wood(size, dark, light, seed + 1)
    shifted = np.stack(
        [
            np.roll(grain[row], shift, axis=0)
            for row, shift in zip(rows, random.integers(0, size, boards)[board], strict=True)
        ]
    )
    tone = random.uniform(0.9, 1.06, boards)[board]
    into = (rows * boards % size) / boards
    joint = np.clip(np.minimum(into, size / boards - into) / (size * 0.008), 0.25, 1.0)
    return shifted * (tone * joint)[:, None, None]


def speckle(size: int, low: str, high: str, seed: int, coarse: float = 6.0, fine: float = 45.0) -> np.ndarray:
    """Cloudy paint, rubber, plaster or grass, depending on the colours."""
    share = 0.5 + 0.17 * noise(size, coarse, seed) + 0.10 * noise(size, fine, seed + 1)
    return blend(low, high, share)


def lines(size: int, count: int, width: float) -> np.ndarray:
    """(size, size) mask of ``count`` squares per side: 1 on their borders, ``width`` as a share of a square."""
    place = (np.arange(size) + 0.5) / size * count
    distance = np.abs(place - np.round(place))
    soft = count / size
    line = np.clip((width / 2 - distance) / soft + 0.5, 0.0, 1.0)
    return np.maximum(line[:, None], line[None, :])
