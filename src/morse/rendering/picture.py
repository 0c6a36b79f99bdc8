"""Images of cameras: complete, or drawn later."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple, Protocol

import numpy as np

from morse.rendering.textures import LIGHT, encoded

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from morse.scene import Node


class Picture(NamedTuple):
    """An image of a camera; its arrays are not shared.

    Attributes:
        rgba: (H, W, 4) uint8, opaque; None if it was not requested.
        depth: (H, W) float32, metres along the axis of the camera, 0 without a surface.
        ids: (H, W) int32, index in `nodes`, -1 without a surface.
        normals: (H, W, 3) float32, unit normals of the surfaces, towards the camera: X right, Y down, Z forward; 0
            without a surface; None if they were not requested.
        nodes: the nodes of the ids; empty for an image from a saved state.
        names: the names of the nodes.
        models: (I, 12) float32, mesh to world of each node, 3x4 row by row; zeros for invisible nodes.
        eye: (3,) float32, position of the camera in the world frame.
        axes: (3, 3) float32, its right, down and forward axes, in rows.
    """

    rgba: NDArray[np.uint8] | None
    depth: NDArray[np.float32]
    ids: NDArray[np.int32]
    normals: NDArray[np.float32] | None
    nodes: list[Node]
    names: list[str]
    models: NDArray[np.float32]
    eye: NDArray[np.float32]
    axes: NDArray[np.float32]

    @property
    def rgb(self) -> NDArray[np.uint8] | None:
        """(H, W, 3) uint8, the colours without opacity; shares the memory of `rgba`."""
        return None if self.rgba is None else self.rgba[..., :3]


# Images that are complete, or will be.


class Shot(Protocol):
    """An image that is complete, or will be."""

    def picture(self) -> Picture:
        """Return the image, and wait until it is complete; raise the error that has ended its rendering."""


class Finished:
    """An image that is complete."""

    def __init__(self, picture: Picture) -> None:
        self._picture = picture

    def picture(self) -> Picture:
        """Return the image."""
        return self._picture


# Noise of a camera sensor: shot noise, read-out noise, and stuck pixels.
#
# The model follows the standard EMVA 1288: the standard deviation of the number of electrons is its square root, and
# the read-out adds the same noise to all pixels. The Poisson distribution is approximated by a Gaussian distribution,
# which is accurate for many electrons.


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
