"""Sends recorded data of sensors to pages that show a recorded run."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from morse.core.exceptions import MorseError
from morse.core.kinds import bind
from morse.middleware.ros2.cdr import CdrError, decode
from morse.viewer.feeds.values import shown
from morse.viewer.view_messages import Values

if TYPE_CHECKING:
    from collections.abc import Mapping

    from morse.core.context import Context
    from morse.recording.mcap.reader import Channel
    from morse.simulation.recorded_timeline import RecordedTimeline
    from morse.viewer.server import ViewServer

_POSES = ("geometry_msgs/msg/PoseStamped", "geometry_msgs/msg/PoseWithCovarianceStamped")
_SCAN = "sensor_msgs/msg/LaserScan"
#: images have panels of their own
_WITHOUT = ("sensor_msgs/msg/Image", "sensor_msgs/msg/CompressedImage", "sensor_msgs/msg/PointCloud2")


class RecordedValuesFeed:
    """Sends the last recorded message of each sensor that pages show.

    Poses and scans have the names of the fields of the sensor; the values of other messages have the names of ROS.

    Args:
        context: of the simulation.
        server: the server of the pages.
        timeline: the recorded run.
        channels: channels of the recording by the name of the sensor.
    """

    def __init__(
        self,
        context: Context,
        server: ViewServer,
        timeline: RecordedTimeline,
        channels: Mapping[str, list[Channel]],
    ) -> None:
        self._context, self._server = context, server
        self._timeline = timeline
        self._channels = channels

    def update(self) -> None:
        """Send the data that pages show."""
        for name in sorted(self._server.wishes.values):
            component = self._context.components.get(name)
            data: dict[str, Any] = {}
            for channel in self._channels.get(name, ()) if component is not None else ():
                data |= self._of(channel, component)
            if data:
                time = float(data.get("timestamp", self._context.clock.time))
                self._server.send(Values(name, time, {field: shown(value) for field, value in data.items()}))

    def _of(self, channel: Channel, component: Any) -> dict[str, Any]:
        if channel.type in _WITHOUT:
            return {}
        try:
            message = self._timeline.recorded.history.last(channel.number, self._timeline.log_time + 1000)
            if message is None:
                return {}
            data = fields_of(decode(channel.type, message.data), channel.type, component)
        except (CdrError, MorseError, ValueError, LookupError, TypeError):  # a damaged message is not shown
            return {}
        return {"timestamp": message.publish_time / 1e9, **data}


def fields_of(message: dict[str, Any], type_name: str, component: Any) -> dict[str, Any]:
    """The fields of a component in a message, or the fields of the message, without its header.

    Args:
        message: decoded.
        type_name: its type.
        component: the sensor that sent it.
    """
    if type_name in _POSES:
        pose = message["pose"].get("pose", message["pose"])
        place, turn = pose["position"], pose["orientation"]
        slots = {"position": [place[axis] for axis in "xyz"], "orientation": [turn[axis] for axis in "wxyz"]}
        kinds = [kind for kind in bind(component) if kind.kind.name == "pose"]
        return kinds[0].scatter(slots)[0] if kinds else slots
    if type_name == _SCAN:
        ranges = np.asarray(message["ranges"], dtype=np.float64)
        return {"range_list": np.where(np.isfinite(ranges), ranges, message["range_max"])}
    return {name: value for name, value in message.items() if name != "header"}
