"""Conversion between sRGB values and linear light."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from morse.kernel.drawing.arrays import ENCODED
from morse.rendering.textures import LINEAR

if TYPE_CHECKING:
    from numpy.typing import NDArray

#: (256,) float32, the light of each code, 0 to 1
LIGHT = LINEAR.astype(np.float32)
_STEPS = np.float32(len(ENCODED) - 1)


def encoded(light: NDArray[np.float32]) -> NDArray[np.uint8]:
    """Convert linear light to sRGB values; light is clipped to 0..1."""
    steps = np.clip(light, np.float32(0), np.float32(1)) * _STEPS + np.float32(0.5)
    return np.asarray(ENCODED[steps.astype(np.intp)], np.uint8)
