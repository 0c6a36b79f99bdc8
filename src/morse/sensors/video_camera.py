"""Colour pictures."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from morse.core.declarations import BuilderDefaults
from morse.helpers.components import add_data, add_kind
from morse.sensors.camera import CAMERA_INFO, INTRINSIC, Camera

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from morse.rendering import Picture


def _pixels(camera: VideoCamera) -> NDArray[np.uint8]:
    """(H, W, 4) RGBA, the top row first."""
    return camera.top_first(camera.local_data["image"])


class VideoCamera(Camera):
    """Takes colour pictures."""

    _name = "Video camera"
    _short_desc = "A camera capturing RGBA image"
    _builder = BuilderDefaults(
        frequency=20.0,
        properties={"cam_focal": 35.0},
        model="camera",
        part="CameraMesh",
    )

    add_data(
        "image",
        np.zeros((0, 0, 4), np.uint8),
        "buffer",
        "The picture, RGBA",
        frame="optical",
        shape=(None, None, 4),
        dtype="uint8",
        low=0,
        high=255,
    )

    add_data("intrinsic_matrix", **INTRINSIC)

    add_kind("image", pixels=_pixels, encoding="rgba8")
    add_kind("camera_info", **CAMERA_INFO)

    def take(self, picture: Picture) -> None:
        """Keep the picture, opaque."""
        assert picture.rgb is not None
        image = np.full((*picture.rgb.shape[:2], 4), 255, np.uint8)
        image[..., :3] = picture.rgb
        self.local_data["image"] = self.ordered(image)

    def noisy_fields(self) -> tuple[str, ...]:
        """None: a buffer of bytes is not a measured vector."""
        return ()
