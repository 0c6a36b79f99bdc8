"""Point clouds over the socket, under the names of MORSE 1.4."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from morse.middleware.socket.streams import SocketPublisher
from morse.wire.images import cloud_fields

if TYPE_CHECKING:
    from collections.abc import Mapping


class DepthCameraPublisher(SocketPublisher):
    """A cloud in the format of `morse.wire.images.cloud_fields`, for a component of any kind."""

    def encode(self) -> Mapping[str, Any] | None:
        """The message, or None while the camera does not capture."""
        camera: Any = self.component_instance
        return None if camera.capturing is False else cloud_fields(camera, self.data)
