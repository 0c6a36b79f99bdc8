"""Sends camera images to pages."""

from __future__ import annotations

import io
import math
import zlib
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

import numpy as np

from morse.core.colors.image_colors import as_pixels, depth_levels, is_picture, is_temperature, unit_of
from morse.viewer.view_messages import Picture, Sighting

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from numpy.typing import NDArray

    from morse.core.context import Context
    from morse.core.values import Fields
    from morse.viewer.server import ViewServer

_QUALITY = 85
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

    image: np.ndarray
    source: object
    time: float
    objects: Any = ()


class PicturesFeed:
    """Sends the images of the cameras whose panels are open."""

    def __init__(self, context: Context, server: ViewServer) -> None:
        self._context = context
        self._server = server
        self._last_pictures: Fields = {}

    def update(self) -> None:
        """Send the images captured since the last call."""
        wishes = self._server.wishes.images
        for name in self._last_pictures.keys() - wishes:
            del self._last_pictures[name]
            self._watch(name, False)
        for name in sorted(wishes):
            component = self._context.components.get(name)
            self._watch(name, True)
            shot = None if component is None else self.shot(name, component)
            if shot is None or shot.source is self._last_pictures.get(name):
                continue
            self._last_pictures[name] = shot.source
            self._server.send(picture_of(name, component, shot))

    def _watch(self, name: str, on: bool) -> None:
        """A camera without an image in its data renders one only while a page shows it."""
        component: Any = self._context.components.get(name)
        if hasattr(component, "shown"):
            component.watched = on
            self._last_pictures.setdefault(name, None)

    def shot(self, _name: str, component: Any) -> Shot | None:
        """The last image of a camera."""
        show = getattr(component, "shown", None)
        return shot_of(component, component.local_data if show is None else show())


def shot_of(component: object, data: Mapping[str, object]) -> Shot | None:
    """The image in the data of a camera; None if there is none."""
    image = data.get("image")
    if not is_picture(image):
        return None
    top_first = image if getattr(component, "vertical_flip", True) else image[::-1]
    time = data.get("timestamp", 0.0)
    return Shot(top_first, image, time if isinstance(time, float) else 0.0, data.get("objects", ()))


def picture_of(name: str, component: object, shot: Shot) -> Picture:
    """The message for an image of a camera."""
    image = shot.image
    height, width = image.shape[:2]
    if image.dtype == np.uint16 and image.ndim == 2:
        rows = zlib.compress(np.ascontiguousarray(image, "<u2").data, 1)
        objects = list(sightings(shot.objects))
        return Picture(rows, name, width, height, "image/x-u16", shot.time, "ids", sightings=objects)
    if image.ndim == 2 and image.dtype != np.uint8:
        levels = depth_levels(image)
        unit = unit_of(component)
        jpeg = as_jpeg(levels.grey)
        meaning: Literal["depth", "temperature"] = "temperature" if is_temperature(component) else "depth"
        return Picture(jpeg, name, width, height, "image/jpeg", shot.time, meaning, levels.low, levels.high, unit)
    boxes = list(sightings(shot.objects))
    return Picture(as_jpeg(as_pixels(image)), name, width, height, "image/jpeg", shot.time, sightings=boxes)


def sightings(objects: object) -> Iterator[Sighting]:
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


def as_jpeg(pixels: NDArray[np.uint8]) -> bytes:
    """Encode an image as a file."""
    # imported with the first image
    from PIL import Image

    data = io.BytesIO()
    Image.fromarray(pixels).save(data, "JPEG", quality=_QUALITY)
    return data.getvalue()
