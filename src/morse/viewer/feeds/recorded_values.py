"""Sends recorded data of sensors to pages that show a recorded run."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.core.actuator import Actuator
from morse.core.journal import COMMAND
from morse.recording.errors import RecordingError
from morse.viewer.feeds.values import shown
from morse.viewer.view_messages import Values

if TYPE_CHECKING:
    from morse.core.context import Context
    from morse.core.object import Object
    from morse.core.values import JsonObject
    from morse.recording.fields.reading import RecordedFields
    from morse.simulation.recordings.recorded_timeline import RecordedTimeline
    from morse.viewer.server import ViewServer


class RecordedValuesFeed:
    """Sends the recorded data of each sensor, and the last command of each actuator, that pages show.

    A sensor that was not recorded has a note.

    Args:
        context: of the simulation.
        server: the server of the pages.
        timeline: the recorded run.
        fields: the recorded data.
    """

    def __init__(
        self, context: Context, server: ViewServer, timeline: RecordedTimeline, fields: RecordedFields
    ) -> None:
        self._context, self._server = context, server
        self._timeline, self._fields = timeline, fields

    def update(self) -> None:
        """Send the data that pages show."""
        for name in sorted(self._server.wishes.values):
            component = self._context.components.get(name)
            time = self._context.clock.time
            if isinstance(component, Actuator):
                data, note = self._commanded(component)
            elif component is not None:
                data, note = self.measured(name)
                stamp = data.get("timestamp")
                time = stamp if isinstance(stamp, float) else time
            else:
                data, note = {}, "not recorded" if name in self._context.robots else ""
            if data or note:
                self._server.send(Values(name, time, {field: shown(value) for field, value in data.items()}, note))

    def measured(self, name: str) -> tuple[JsonObject, str]:
        """The last recorded data of a sensor, and a note."""
        if name not in self._fields:
            return {}, "not recorded"
        try:
            fields = self._fields.last(name, self._timeline.log_time + 1000)
        except RecordingError:  # damaged data are not shown
            return {}, ""
        return ({}, "no data recorded until here") if fields is None else (fields.values, "")

    def _commanded(self, component: Object) -> tuple[JsonObject, str]:
        """The last command; an actuator that was not commanded has the values of its declaration."""
        command = self._timeline.last_input(COMMAND, component.name())
        return (dict(component.local_data), "") if command is None else (dict(command), "the last recorded command")
