"""Colours by hexadecimal code."""

from __future__ import annotations

import numpy as np


def srgb(code: str) -> np.ndarray:
    """``#rrggbb`` as sRGB values, 0..1, for images."""
    return np.array([int(code[i : i + 2], 16) / 255 for i in (1, 3, 5)])


def linear(code: str) -> tuple[float, float, float]:
    """``#rrggbb`` as linear light, 0..1, for materials."""
    value = srgb(code)
    light = np.where(value <= 0.04045, value / 12.92, ((value + 0.055) / 1.055) ** 2.4)
    return tuple(float(v) for v in light)


# the palette of all models
CREAM = "#f3e9d2"
WHITE = "#f4f3ee"
TEAL = "#1f8a8c"
DEEP_TEAL = "#125b66"
MINT = "#9fd8c4"
CORAL = "#ee6c4d"
SUN = "#f5b83d"
SKY = "#5aa9e6"
BERRY = "#c8436b"
LEAF = "#6fae5a"
PLUM = "#7a5ea8"
NAVY = "#16222e"
RUBBER = "#26292d"
STEEL = "#a9b0b6"
