"""Images over the socket, under the names of MORSE 1.4."""

from __future__ import annotations

from morse.middleware.socket.streams import SocketPublisher
from morse.wire.images import as_bytes, grey, image_json


class VideoPublisher(SocketPublisher):
    """An image with only the fields of 1.4, in the format of `morse.wire.images.image_json`."""

    def pixels(self) -> bytes:
        """The bytes of the image, row by row; RGBA."""
        return as_bytes(self.data["image"])

    def encode(self) -> bytes | None:
        """The message, or None while the camera does not capture."""
        return image_json(self, lambda _: self.pixels(), others=False)


class Video8uPublisher(VideoPublisher):
    """The same with one byte per pixel: its luminance."""

    def pixels(self) -> bytes:
        """The bytes of the grey image, row by row."""
        return grey(self.data["image"])
