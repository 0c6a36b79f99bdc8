"""Images over the socket, under the names of MORSE 1.4."""

from __future__ import annotations

from typing import Any

from morse.middleware.socket.streams import SocketPublisher
from morse.wire.images import PictureFields, as_bytes, grey, image_fields

_FIELDS = ("timestamp", "height", "width", "image", "intrinsic_matrix")


class VideoPublisher(SocketPublisher):
    """An image with only the fields of 1.4, in the format of `morse.wire.images.image_fields`."""

    def pixels(self) -> bytes:
        """The bytes of the image, row by row; RGBA."""
        return as_bytes(self.data["image"])

    def encode(self) -> bytes | None:
        """The message, or None while the camera does not capture."""
        camera: Any = self.component_instance
        if camera.capturing is False:
            return None
        fields = image_fields(camera, {**self.data, "image": self.pixels()})
        return PictureFields({name: fields[name] for name in _FIELDS if name in fields}).line()


class Video8uPublisher(VideoPublisher):
    """The same with one byte per pixel: its luminance."""

    def pixels(self) -> bytes:
        """The bytes of the grey image, row by row."""
        return grey(self.data["image"])
