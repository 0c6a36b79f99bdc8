"""Sends camera images to pages."""

from __future__ import annotations

import io
import math
import zlib
from typing import TYPE_CHECKING, Any, Literal, NamedTuple, TypeGuard

import numpy as np

from morse.core.declarations import fields_of_component
from morse.viewer.feeds.id_colors import as_colors, as_directions
from morse.viewer.view_messages import Picture, Sighting

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from morse.core.context import Context
    from morse.viewer.server import ViewServer

FARTHEST_LEVEL = 32
"""The grey value of the largest depth in an image: JPEG compression does not mix it with the black of no depth."""

_QUALITY = 85
#: from cold to hot; the twin of ``DEPTHS`` of the page
_HEAT = ((44, 36, 104), (84, 42, 134), (140, 46, 124), (205, 62, 92), (244, 122, 60), (255, 196, 92), (255, 246, 190))
_OF_TEMPERATURE = ("°C", "K", "°F")
#: maximum number of objects with boxes that are sent with an image
_MOST_SIGHTINGS = 200
_LONGEST_NAME = 80


class Shot(NamedTuple):
    """An image of a camera.

    Attributes:
        image: the top row is first.
        source: changes with every new image.
        time: simulated seconds.
        objects: the objects that the camera has detected.
    """

    image: NDArray[Any]
    source: object
    time: float
    objects: Any = ()


class PicturesFeed:
    """Sends the images of the cameras whose panels are open."""

    def __init__(self, context: Context, server: ViewServer) -> None:
        self._context = context
        self._server = server
        self._sent: dict[str, object] = {}

    def update(self) -> None:
        """Send the images captured since the last call."""
        wished = self._server.wishes.images
        for name in self._sent.keys() - wished:
            del self._sent[name]
        for name in sorted(wished):
            component = self._context.components.get(name)
            shot = None if component is None else self.shot(name, component)
            if shot is None or shot.source is self._sent.get(name):
                continue
            self._sent[name] = shot.source
            self._server.send(picture_of(name, component, shot))

    def shot(self, _name: str, component: Any) -> Shot | None:
        """The last image of a camera."""
        image = component.local_data.get("image")
        if not is_picture(image):
            return None
        data = component.local_data
        top_first = image if getattr(component, "vertical_flip", True) else image[::-1]
        return Shot(top_first, image, float(data.get("timestamp", 0.0)), data.get("objects", ()))


def picture_of(name: str, component: Any, shot: Shot) -> Picture:
    """The message for an image of a camera."""
    image = shot.image
    height, width = image.shape[:2]
    if image.dtype == np.uint16 and image.ndim == 2:
        rows = zlib.compress(np.ascontiguousarray(image, "<u2").data, 1)
        found = list(sightings(shot.objects))
        return Picture(rows, name, width, height, "image/x-u16", shot.time, "ids", sightings=found)
    if image.ndim == 2 and image.dtype != np.uint8:
        levels = depth_levels(image)
        unit = getattr(fields_of_component(component).get("image"), "unit", "")
        jpeg = as_jpeg(levels.grey)
        meaning: Literal["depth", "temperature"] = "temperature" if unit in _OF_TEMPERATURE else "depth"
        return Picture(jpeg, name, width, height, "image/jpeg", shot.time, meaning, levels.low, levels.high, unit)
    return Picture(as_jpeg(as_pixels(image)), name, width, height, "image/jpeg", shot.time)


class Levels(NamedTuple):
    """Depths as grey values, and the depths of the brightest and the darkest value."""

    grey: NDArray[np.uint8]
    low: float
    high: float


def depth_levels(image: NDArray[Any]) -> Levels:
    """Depths (H, W) as grey values from 255, the smallest, to `FARTHEST_LEVEL`; 0 for depths that are not finite."""
    known = np.isfinite(image)
    if not known.any():
        return Levels(np.zeros(image.shape, np.uint8), 0.0, 0.0)
    values = np.where(known, image, 0).astype(np.float32)
    low = float(values.min(initial=math.inf, where=known))
    high = float(values.max(initial=-math.inf, where=known))
    steps = 255 - FARTHEST_LEVEL
    share = (values - np.float32(low)) * np.float32(steps / (high - low) if high > low else 0.0)
    grey = 255 - np.clip(share + np.float32(0.5), 0, steps).astype(np.uint8)
    grey[~known] = 0
    return Levels(grey, low, high)


def sightings(objects: Any) -> Iterator[Sighting]:
    """The objects of a camera that have a box; invalid entries are left out."""
    for thing in list(objects)[:_MOST_SIGHTINGS] if isinstance(objects, (list, tuple)) else ():
        if not isinstance(thing, dict):
            continue
        try:
            x0, y0, x1, y1 = (float(edge) for edge in thing["box"])
            number = int(thing.get("id", 0))
        except (TypeError, ValueError, KeyError, OverflowError):
            continue
        if all(map(math.isfinite, (x0, y0, x1, y1))):
            label, kind = (str(thing.get(key, ""))[:_LONGEST_NAME] for key in ("name", "class"))
            yield Sighting(number, label, kind, (x0, y0, x1, y1))


def is_picture(image: Any) -> TypeGuard[NDArray[Any]]:
    """Whether it is an image that can be shown."""
    if not isinstance(image, np.ndarray) or image.dtype.kind not in "fiub" or not image.size:
        return False
    channels = (3, 4) if image.dtype == np.uint8 else (2, 3)
    return image.ndim == 2 or (image.ndim == 3 and image.shape[2] in channels)


def as_pixels(image: NDArray[Any]) -> NDArray[np.uint8]:
    """Convert an image to pixels (H, W) or (H, W, 3) for display.

    Colours are unchanged, each id (H, W) uint16 gets a colour, depths are shown from white (near) to black. Vectors
    (H, W, 2) are coloured by direction. Normals (H, W, 3) have their coordinates as red, green and blue,
    with the side that faces the camera bright; pixels without a normal are black.
    """
    if image.dtype == np.uint8:
        return np.ascontiguousarray(image[..., :3] if image.ndim == 3 else image)
    if image.dtype == np.uint16 and image.ndim == 2:
        return as_colors(image)
    if image.ndim == 3 and image.shape[2] == 2:
        return as_directions(image)
    if image.ndim == 3 and image.shape[2] == 3:
        return as_coordinates(image)
    values = np.asarray(image, dtype=np.float64)
    known = values[np.isfinite(values)]
    if not known.size:
        return np.zeros(image.shape, np.uint8)
    low, high = float(known.min()), float(known.max())
    share = (values - low) / max(high - low, 1e-9)
    return (255 * (1.0 - np.clip(np.nan_to_num(share, nan=1.0, posinf=1.0, neginf=0.0), 0.0, 1.0))).astype(np.uint8)


def as_coordinates(normals: NDArray[Any]) -> NDArray[np.uint8]:
    """Colours of unit vectors (H, W, 3): right is red, up is green, towards the camera is blue; zeros are black."""
    colors: NDArray[np.float64] = 127.5 + 127.5 * np.clip(np.nan_to_num(normals), -1.0, 1.0) * np.array(
        (1.0, -1.0, -1.0)
    )
    colors[~np.any(normals, axis=2)] = 0.0
    return np.asarray(colors + 0.5, np.float64).astype(np.uint8)


def as_heat(image: NDArray[Any]) -> NDArray[np.uint8]:
    """Colours of temperatures (H, W) from dark, cold, to bright, hot, as pages show them."""
    known = image[np.isfinite(image)]
    low, high = (float(known.min()), float(known.max())) if known.size else (0.0, 0.0)
    share = (np.nan_to_num(image, nan=low, posinf=high, neginf=low) - low) / max(high - low, 1e-9)
    steps = np.linspace(0.0, 1.0, len(_HEAT))
    return np.stack([np.interp(share, steps, channel) for channel in np.transpose(_HEAT)], axis=-1).astype(np.uint8)


def as_jpeg(pixels: NDArray[np.uint8]) -> bytes:
    """Encode an image as a file."""
    # imported with the first image
    from PIL import Image

    data = io.BytesIO()
    Image.fromarray(pixels).save(data, "JPEG", quality=_QUALITY)
    return data.getvalue()
