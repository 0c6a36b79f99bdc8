"""Point clouds over the socket, under the names of MORSE 1.4."""

from __future__ import annotations

from morse.middleware.socket.streams import SocketPublisher
from morse.wire.images import cloud_json


class DepthCameraPublisher(SocketPublisher):
    """A cloud in the format of `morse.wire.images.cloud_json`, for a component of any kind."""

    def encode(self) -> bytes | None:
        """The message, or None while the camera does not capture."""
        return cloud_json(self)
