"""Noise of a camera sensor: shot noise, read-out noise, and stuck pixels.

The model follows the standard EMVA 1288: the standard deviation of the number of electrons is its square root, and the
read-out adds the same noise to all pixels. The Poisson distribution is approximated by a Gaussian distribution, which
is accurate for many electrons.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from morse.rendering.textures import LIGHT, encoded

if TYPE_CHECKING:
    from numpy.typing import NDArray


class Chip(NamedTuple):
    """The parameters of a sensor.

    Attributes:
        full_well: electrons of the brightest pixel; 0 for no shot noise.
        read_noise: standard deviation of the read-out, as a share of the brightest pixel.
        stuck: share of the pixels that are always black or always white, half of them each.
    """

    full_well: float = 0.0
    read_noise: float = 0.0
    stuck: float = 0.0


def exposed(
    chip: Chip, rgb: NDArray[np.uint8], random: np.random.Generator, flaws: np.random.Generator
) -> NDArray[np.uint8]:
    """Return an image (H, W, 3) with sensor noise.

    Args:
        random: generator for this image.
        flaws: generator for the stuck pixels; the same for all images of a camera.
    """
    if chip.full_well or chip.read_noise:
        light = LIGHT[rgb]
        spread = np.full(light.shape, np.float32(chip.read_noise) ** 2, np.float32)
        if chip.full_well:
            spread += light * np.float32(1.0 / max(chip.full_well, 1.0))  # at least one electron
        noise = random.standard_normal(light.shape, np.float32)
        rgb = encoded((light + np.sqrt(spread) * noise).astype(np.float32))
    if chip.stuck:
        draws = flaws.random(rgb.shape[:2], dtype=np.float32)
        rgb = rgb.copy()
        rgb[draws < np.float32(chip.stuck)] = 255
        rgb[draws < np.float32(chip.stuck / 2)] = 0
    return rgb
