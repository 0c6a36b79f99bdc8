"""Point clouds as JSON, the points in base64."""

from __future__ import annotations

import base64
from typing import Any

import numpy as np

from morse.middleware.socket.encoding import to_json
from morse.middleware.socket.streams import SocketPublisher


class DepthCameraPublisher(SocketPublisher):
    """``{timestamp, height, width, points, intrinsic_matrix}``; points are x, y, z in float32, in base64.

    Nothing is sent while the camera does not capture.
    """

    def encode(self) -> bytes | None:
        """The message, or None while the camera does not capture."""
        camera: Any = self.component_instance
        if not camera.capturing:
            return None
        points = self.data["points"]
        raw = bytes(points) if isinstance(points, (bytes, bytearray, memoryview)) else np.float32(points).tobytes()
        return to_json(
            {
                "timestamp": self.data["timestamp"],
                "height": camera.image_height,
                "width": camera.image_width,
                "points": base64.b64encode(raw).decode("ascii"),
                "intrinsic_matrix": self.data["intrinsic_matrix"],
            }
        )
