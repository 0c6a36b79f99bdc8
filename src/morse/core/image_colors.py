"""Camera images in colours for people: depths, ids, temperatures, normals and vectors."""

from __future__ import annotations

import colorsys
import io
import math
from functools import cache
from typing import TYPE_CHECKING, NamedTuple, TypeGuard

import numpy as np

from morse.core.declarations import fields_of_component
from morse.mathutils import portable

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from morse.core.object import Object


#: shortest length of a vector with a full colour, px: the rounding errors of a scene at rest have none
_SHORTEST = 0.1
#: the golden ratio: consecutive hues differ strongly
_STEP = 0.6180339887


@cache
def _palette(size: int) -> NDArray[np.uint8]:
    colors = [
        colorsys.hsv_to_rgb(i * _STEP % 1.0, (0.75, 0.5)[i // 8 % 2], (0.95, 0.7)[i // 16 % 2]) for i in range(size)
    ]
    bytes_of_colors = np.round(np.array(colors) * 255).astype(np.uint8)
    bytes_of_colors[0] = 0
    return bytes_of_colors


def as_colors(ids: NDArray[np.integer]) -> NDArray[np.uint8]:
    """(H, W, 3) a colour for each id, black for 0."""
    size = 1 << int(ids.max(initial=0)).bit_length()
    return np.asarray(_palette(size)[ids], np.uint8)


def as_directions(flow: NDArray[np.floating]) -> NDArray[np.uint8]:
    """Colours (H, W, 3) of vectors (H, W, 2): the hue is the direction, and the saturation grows with the length.

    Pixels without a vector are black, pixels at rest are white.
    """
    is_known = np.isfinite(flow).all(axis=2)
    x, y = (np.where(is_known, flow[..., axis], 0.0).astype(np.float64) for axis in range(2))
    length = np.hypot(x, y)
    share = length / max(float(length.max(initial=0.0)), _SHORTEST)
    hue = portable.arctan2(y, x)
    # three cosines, shifted by a third of a turn
    colors = [1.0 - share * (0.5 - 0.5 * portable.cos(hue - third)) for third in (0.0, 2.0944, 4.1888)]
    pixels = np.round(np.stack(colors, axis=-1) * 255).astype(np.uint8)
    pixels[~is_known] = 0
    return pixels


FARTHEST_LEVEL = 32
"""The grey value of the largest depth in an image: JPEG compression does not mix it with the black of no depth."""

#: from cold to hot; the twin of ``DEPTHS`` of the page
_HEAT = ((44, 36, 104), (84, 42, 134), (140, 46, 124), (205, 62, 92), (244, 122, 60), (255, 196, 92), (255, 246, 190))
_OF_TEMPERATURE = ("°C", "K", "°F")


class Levels(NamedTuple):
    """Depths as grey values, and the depths of the brightest and the darkest value."""

    grey: NDArray[np.uint8]
    low: float
    high: float


def depth_levels(image: NDArray[np.generic]) -> Levels:
    """Depths (H, W) as grey values from 255, the smallest, to `FARTHEST_LEVEL`; 0 for depths that are not finite."""
    is_finite = np.isfinite(image)
    if not is_finite.any():
        return Levels(np.zeros(image.shape, np.uint8), 0.0, 0.0)
    values = np.where(is_finite, image, 0).astype(np.float32)
    low = float(values.min(initial=math.inf, where=is_finite))
    high = float(values.max(initial=-math.inf, where=is_finite))
    steps = 255 - FARTHEST_LEVEL
    share = (values - np.float32(low)) * np.float32(steps / (high - low) if high > low else 0.0)
    grey = 255 - np.clip(share + np.float32(0.5), 0, steps).astype(np.uint8)
    grey[~is_finite] = 0
    return Levels(grey, low, high)


def is_picture(image: object) -> TypeGuard[NDArray[np.generic]]:
    """Whether it is an image that can be shown."""
    if not isinstance(image, np.ndarray) or image.dtype.kind not in "fiub" or not image.size:
        return False
    channels = (3, 4) if image.dtype == np.uint8 else (2, 3)
    return image.ndim == 2 or (image.ndim == 3 and image.shape[2] in channels)


def as_pixels(image: np.ndarray) -> NDArray[np.uint8]:
    """Convert an image to pixels (H, W) or (H, W, 3) for display.

    Colours are unchanged, each id (H, W) uint16 gets a colour. Depths are shown from white (near) to dark grey, and
    black without a surface. Vectors (H, W, 2) are coloured by direction. Normals (H, W, 3) have their coordinates as
    red, green and blue, with the side that faces the camera bright; pixels without a normal are black.
    """
    if image.dtype == np.uint8:
        return np.ascontiguousarray(image[..., :3] if image.ndim == 3 else image)
    if image.dtype == np.uint16 and image.ndim == 2:
        return as_colors(image)
    if image.ndim == 3 and image.shape[2] == 2:
        return as_directions(image)
    if image.ndim == 3 and image.shape[2] == 3:
        return as_coordinates(image)
    return depth_levels(image).grey


def as_coordinates(normals: NDArray[np.generic]) -> NDArray[np.uint8]:
    """Colours of unit vectors (H, W, 3): right is red, up is green, towards the camera is blue; zeros are black."""
    colors: NDArray[np.float64] = 127.5 + 127.5 * np.clip(np.nan_to_num(normals), -1.0, 1.0) * np.array(
        (1.0, -1.0, -1.0)
    )
    colors[~np.any(normals, axis=2)] = 0.0
    return np.asarray(colors + 0.5, np.float64).astype(np.uint8)


def as_heat(image: NDArray[np.generic]) -> NDArray[np.uint8]:
    """Colours of temperatures (H, W) from dark, cold, to bright, hot, as pages show them."""
    finite_values = image[np.isfinite(image)]
    low, high = (float(finite_values.min()), float(finite_values.max())) if finite_values.size else (0.0, 0.0)
    share = (np.nan_to_num(image, nan=low, posinf=high, neginf=low) - low) / max(high - low, 1e-9)
    steps = np.linspace(0.0, 1.0, len(_HEAT))
    return np.stack([np.interp(share, steps, channel) for channel in np.transpose(_HEAT)], axis=-1).astype(np.uint8)


def unit_of(component: object) -> str:
    """The unit of the pixels of a camera."""
    return str(getattr(fields_of_component(component).get("image"), "unit", ""))


def is_temperature(component: object) -> bool:
    """Whether the images of a camera contain temperatures."""
    return unit_of(component) in _OF_TEMPERATURE


def png_of(component: Object) -> bytes | None:
    """Return the present image of a camera as a PNG file, in the colours of `as_pixels` and `as_heat`.

    Returns:
        None for a component without an image, and before its first image.
    """
    # imported with the first image
    from PIL import Image

    image = component.local_data.get("image")
    if not is_picture(image):
        return None
    top_first = image if getattr(component, "vertical_flip", True) else image[::-1]
    pixels = as_heat(top_first) if is_temperature(component) else as_pixels(top_first)
    file = io.BytesIO()
    Image.fromarray(pixels).save(file, "PNG")
    return file.getvalue()
