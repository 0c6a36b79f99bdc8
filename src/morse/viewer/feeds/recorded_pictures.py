"""Sends recorded images of cameras to pages that show a recorded run."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from morse.core.colors.image_colors import is_picture
from morse.core.context import acting
from morse.core.exceptions import MorseError
from morse.rosmsgs.cdr import CdrError, decode
from morse.viewer.feeds.pictures import PicturesFeed, Shot
from morse.viewer.feeds.recorded_world import look_around

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from numpy.typing import NDArray

    from morse.core.context import Context
    from morse.recording.mcap.records import Message
    from morse.recording.recording import Recording
    from morse.viewer.server import ViewServer

IMAGE = "sensor_msgs/msg/Image"
#: element type and number of channels by the encoding of ROS
_ENCODINGS = {
    "rgba8": ("u1", 4),
    "rgb8": ("u1", 3),
    "mono8": ("u1", 1),
    "16UC1": ("u2", 1),
    "32FC1": ("f4", 1),
    "32FC2": ("f4", 2),
}
#: maximum number of chunks that are searched for an image: older images are not shown
_MOST_CHUNKS = 200
#: ns: tolerance for rounded times of messages
_ROUNDING = 1_000_000


class RecordedPicturesFeed(PicturesFeed):
    """Sends the recorded images of cameras; images of cameras that were not recorded are those of the simulation.

    Args:
        context: of the simulation.
        server: the server of the pages.
        recording: the recording of the run.
        topic: returns the topic of a camera by the name of the camera, without the suffix for its images; None for a
            camera that does not exist at present.
        time: the present time of the recording, s.
        looks: whether cameras that were not recorded have to capture images of the present world, because nothing is
            simulated.
    """

    def __init__(
        self,
        context: Context,
        server: ViewServer,
        recording: Recording,
        topic: Callable[[str], str | None],
        time: Callable[[], float],
        *,
        looks: bool = False,
    ) -> None:
        super().__init__(context, server)
        self._recording = recording
        self._time = time
        self._topic = topic
        self._channels = [channel for channel in recording.channels.values() if channel.type == IMAGE]
        self._looks = looks
        #: times at which cameras have captured images
        self._looked: dict[str, float] = {}
        self._known: dict[str, tuple[int, int, Shot]] = {}

    def shot(self, name: str, component: Any) -> Shot | None:
        """The last image of the camera at the present time of the recording."""
        channel = self._channel(name)
        if channel is None:
            return self._present(name, component)
        now = round(self._time() * 1e9) + _ROUNDING
        at, stamp, shot = self._known.get(name, (-1, -1, None))
        if at == now:
            return shot
        try:
            message = self._recording.last(channel, now, _MOST_CHUNKS)
            if message is None:
                return None
            if message.log_time != stamp or shot is None:
                shot = _shot(message, component)
        except (CdrError, MorseError, ValueError):
            # a damaged message: show the image of the simulation instead
            return self._present(name, component)
        self._known[name] = (now, message.log_time, shot)
        return shot

    def _channel(self, name: str) -> int | None:
        topic = self._topic(name) if self._channels else None
        if topic is None:
            return None
        found = (one for one in self._channels if one.topic == topic or one.topic.startswith(f"{topic}/"))
        return next((one.number for one in found), None)

    def _present(self, name: str, component: Any) -> Shot | None:
        """The image of the present world."""
        if self._looks and self._looked.get(name) != self._time():
            self._looked[name] = self._time()
            with acting(self._context):
                look_around(component)
        return super().shot(name, component)


def _shot(message: Message, component: Any) -> Shot:
    image = image_of(decode(IMAGE, message.data))
    time = message.publish_time / 1e9
    data = component.local_data
    # boxes are not recorded; those of the simulation are valid if both have the same time
    same = abs(float(data.get("timestamp", -1.0)) - time) < _ROUNDING / 1e9
    return Shot(image, image, time, data.get("objects", ()) if same else ())


def image_of(message: Mapping[str, Any]) -> NDArray[Any]:
    """The pixels of a message ``sensor_msgs/Image``: (H, W) or (H, W, channels).

    Raises:
        ValueError: the message is not an image, or has an encoding that MORSE does not write.
    """
    known = _ENCODINGS.get(message["encoding"])
    if known is None:
        raise ValueError(f"the encoding of the image is {message['encoding']!r:.40}, expected {', '.join(_ENCODINGS)}")
    kind, channels = known
    height, width, step = message["height"], message["width"], message["step"]
    dtype = np.dtype((">" if message["is_bigendian"] else "<") + kind)
    row = width * channels * dtype.itemsize
    data = np.frombuffer(bytes(message["data"]), np.uint8)
    if not height or not width or step < row or len(data) != height * step:
        raise ValueError(f"an image of {width} x {height} pixels with {step} bytes a row has {len(data)} bytes")
    pixels = np.ascontiguousarray(data.reshape(height, step)[:, :row]).view(dtype).reshape(height, width, channels)
    image = pixels.astype(dtype.newbyteorder("="), copy=False)
    image = image[..., 0] if channels == 1 else image
    if not is_picture(image):
        raise ValueError("the image cannot be shown")
    return image
