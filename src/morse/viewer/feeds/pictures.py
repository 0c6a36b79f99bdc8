"""Sends camera images to pages."""

from __future__ import annotations

import io
from typing import TYPE_CHECKING, Any, TypeGuard

import numpy as np

from morse.viewer.feeds.id_colors import as_colors, as_directions, draw_boxes
from morse.viewer.view_messages import Picture

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from morse.core.context import Context
    from morse.viewer.server import ViewServer

_QUALITY = 85


class PicturesFeed:
    """Sends the pictures of the cameras whose panels are open."""

    def __init__(self, context: Context, server: ViewServer) -> None:
        self._context = context
        self._server = server
        self._sent: dict[str, Any] = {}

    def update(self) -> None:
        """Send the pictures that were taken since the last call."""
        wished = self._server.wishes.images
        for name in self._sent.keys() - wished:
            del self._sent[name]
        for name in sorted(wished):
            component = self._context.components.get(name)
            image = None if component is None else component.local_data.get("image")
            if component is None or image is self._sent.get(name) or not _is_picture(image):
                continue
            self._sent[name] = image
            pixels = as_pixels(image if getattr(component, "vertical_flip", True) else image[::-1])
            if image.dtype == np.uint16 and pixels.ndim == 3:
                pixels = draw_boxes(pixels, component.local_data.get("objects", ()))
            height, width = pixels.shape[:2]
            time = float(component.local_data.get("timestamp", 0.0))
            self._server.send(Picture(as_jpeg(pixels), name, width, height, "image/jpeg", time))


def _is_picture(image: Any) -> TypeGuard[NDArray[Any]]:
    if not isinstance(image, np.ndarray) or image.dtype.kind not in "fiub" or not image.size:
        return False
    channels = (3, 4) if image.dtype == np.uint8 else (2, 3)
    return image.ndim == 2 or (image.ndim == 3 and image.shape[2] in channels)


def as_pixels(image: NDArray[Any]) -> NDArray[np.uint8]:
    """Pixels (H, W) or (H, W, 3) to look at.

    Colours stay as they are, ids (H, W) uint16 get a colour each, distances go from white, which is near, to black.
    Vectors (H, W, 2) have colours by their directions.
    """
    if image.dtype == np.uint8:
        return np.ascontiguousarray(image[..., :3] if image.ndim == 3 else image)
    if image.dtype == np.uint16 and image.ndim == 2:
        return as_colors(image)
    if image.ndim == 3 and image.shape[2] == 2:
        return as_directions(image)
    values = np.asarray(image, dtype=np.float64)
    known = values[np.isfinite(values)]
    if not known.size:
        return np.zeros(image.shape, np.uint8)
    low, high = float(known.min()), float(known.max())
    share = (values - low) / max(high - low, 1e-9)
    return (255 * (1.0 - np.clip(np.nan_to_num(share, nan=1.0, posinf=1.0, neginf=0.0), 0.0, 1.0))).astype(np.uint8)


def as_jpeg(pixels: NDArray[np.uint8]) -> bytes:
    """The bytes of a file."""
    # imported when the first picture is shown
    from PIL import Image

    data = io.BytesIO()
    Image.fromarray(pixels).save(data, "JPEG", quality=_QUALITY)
    return data.getvalue()
