"""Images as JSON, the pixels in base64."""

from __future__ import annotations

import base64
from typing import Any

import numpy as np

from morse.middleware.socket.encoding import to_json
from morse.middleware.socket.streams import SocketPublisher

#: the share of each colour in the brightness of a pixel (ITU-R BT.709)
_LUMA = (0.2126, 0.7152, 0.0722)


class VideoPublisher(SocketPublisher):
    """``{timestamp, height, width, image, intrinsic_matrix}``; the image is RGBA, 8 bits each, in base64.

    Nothing is sent while the camera does not capture.
    """

    def pixels(self) -> bytes:
        """The bytes of the image, row by row."""
        return bytes(self.data["image"])

    def encode(self) -> bytes | None:
        """The message, or None while the camera does not capture."""
        camera: Any = self.component_instance
        if not camera.capturing:
            return None
        return to_json(
            {
                "timestamp": self.data["timestamp"],
                "height": camera.image_height,
                "width": camera.image_width,
                "image": base64.b64encode(self.pixels()).decode("ascii"),
                "intrinsic_matrix": self.data["intrinsic_matrix"],
            }
        )


class Video8uPublisher(VideoPublisher):
    """The same with one byte a pixel: its brightness."""

    def pixels(self) -> bytes:
        """The bytes of the grey image, row by row."""
        rgba = np.frombuffer(super().pixels(), dtype=np.uint8).reshape(-1, 4)
        return bytes((rgba[:, :3] @ np.array(_LUMA)).astype(np.uint8).tobytes())
