"""Streams of the socket for images, clouds and joints, under the class names of MORSE 1.4."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from morse.middleware.socket.datastream import SocketPublisher
from morse.wire.encoding import to_json
from morse.wire.images import PictureFields, as_bytes, cloud_fields, grey, image_fields

if TYPE_CHECKING:
    from collections.abc import Mapping

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


class DepthCameraPublisher(SocketPublisher):
    """A cloud in the format of `morse.wire.images.cloud_fields`, for a component of any kind."""

    def encode(self) -> Mapping[str, Any] | None:
        """The message, or None while the camera does not capture."""
        camera: Any = self.component_instance
        return None if camera.capturing is False else cloud_fields(camera, self.data)


class PR2JointStatePublisher(SocketPublisher):
    """One object with ``timestamp`` and all joints of a PR2, rad or m; joints that no sensor measures are 0."""

    def encode(self) -> bytes:
        """The message."""
        positions: dict[str, float] = {}
        for joints in self.data.values():
            if isinstance(joints, dict):
                positions.update(joints)
        names = getattr(self.component_instance.robot_parent, "all_joints", positions)
        return to_json({"timestamp": self.data["timestamp"], **{name: positions.get(name, 0.0) for name in names}})
