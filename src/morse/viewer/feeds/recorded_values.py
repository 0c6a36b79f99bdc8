"""Sends recorded data of sensors to pages that show a recorded run."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from morse.core.actuator import Actuator
from morse.core.journal import COMMAND
from morse.rosmsgs.cdr import decode
from morse.viewer.feeds.recorded_fields import DAMAGED, fields_of
from morse.viewer.feeds.values import shown
from morse.viewer.view_messages import Values

if TYPE_CHECKING:
    from collections.abc import Callable

    from morse.core.context import Context
    from morse.recording.mcap.reader import Channel
    from morse.simulation.recordings.recorded_timeline import RecordedTimeline
    from morse.viewer.server import ViewServer

#: images have panels of their own
_WITHOUT = ("sensor_msgs/msg/Image", "sensor_msgs/msg/CompressedImage", "sensor_msgs/msg/PointCloud2")


class RecordedValuesFeed:
    """Sends the last recorded message of each sensor, and the last command of each actuator, that pages show.

    Values have the names of the fields of the sensor if the message has such fields, else the names of ROS. A sensor
    that was not recorded has a note.

    Args:
        context: of the simulation.
        server: the server of the pages.
        timeline: the recorded run.
        channels: returns the channels of the recording by the name of the sensor.
    """

    def __init__(
        self,
        context: Context,
        server: ViewServer,
        timeline: RecordedTimeline,
        channels: Callable[[str], list[Channel]],
    ) -> None:
        self._context, self._server = context, server
        self._timeline = timeline
        self._channels = channels

    def update(self) -> None:
        """Send the data that pages show."""
        for name in sorted(self._server.wishes.values):
            component = self._context.components.get(name)
            if isinstance(component, Actuator):
                data, note = self._commanded(component)
            elif component is not None:
                data, note = self._measured(name, component)
            else:
                data, note = {}, "not recorded" if name in self._context.robots else ""
            if data or note:
                time = float(data.get("timestamp", self._context.clock.time))
                self._server.send(Values(name, time, {field: shown(value) for field, value in data.items()}, note))

    def _measured(self, name: str, component: Any) -> tuple[dict[str, Any], str]:
        channels = self._channels(name)
        if not channels:
            return {}, "not recorded"
        data: dict[str, Any] = {}
        for channel in channels:
            data |= self._of(channel, component)
        if data:
            return data, ""
        # images and clouds are not shown as numbers
        return {}, "" if any(channel.type in _WITHOUT for channel in channels) else "no message recorded until here"

    def _commanded(self, component: Any) -> tuple[dict[str, Any], str]:
        """The last command; an actuator that was not commanded has the values of its declaration."""
        command = self._timeline.last_input(COMMAND, component.name())
        return (dict(component.local_data), "") if command is None else (dict(command), "the last recorded command")

    def _of(self, channel: Channel, component: Any) -> dict[str, Any]:
        if channel.type in _WITHOUT:
            return {}
        try:
            message = self._timeline.recorded.history.last(channel.number, self._timeline.log_time + 1000)
            if message is None:
                return {}
            topic = channel.topic.rpartition("/")[2]
            data = fields_of(decode(channel.type, message.data), channel.type, component, topic)
        except DAMAGED:  # a damaged message is not shown
            return {}
        return {"timestamp": message.publish_time / 1e9, **data}
