"""What pages show of the sensors of a recorded run."""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING, Any

from morse.core.actuator import Actuator
from morse.core.context import acting
from morse.core.journal import COMMAND
from morse.core.reports.faults import ENDINGS, describe, name_of
from morse.core.requests import serve
from morse.physics.rays.bundle import RayBundle
from morse.recording.errors import RecordingError
from morse.viewer.feeds.components import shown
from morse.viewer.feeds.sensors import PicturesFeed, Shot, shot_of
from morse.viewer.view_messages import Values

if TYPE_CHECKING:
    from collections.abc import Callable, Collection

    from morse.core.context import Context
    from morse.core.object import Object
    from morse.core.values import JsonObject
    from morse.recording.fields.blocks import RecordedFields
    from morse.simulation.recordings.timeline import RecordedTimeline
    from morse.viewer.server import ViewServer


# Sensors that look at the world of a recording: their rays and images were not recorded.

logger = logging.getLogger("morse.viewer")


def look_around(camera: Any) -> None:
    """Capture an image; errors are logged."""
    if camera is None:
        return
    try:
        serve([camera], camera.context.guard)
        camera.action()
    except ENDINGS:
        raise
    except BaseException as error:  # a component of the user may fail
        logger.debug("%s cannot look at the recorded world: %s", name_of(camera), describe(error))


def cast_wished_rays(context: Context, wishes: Collection[str]) -> None:
    """Cast the rays of sensors from their recorded poses, and those with a visible arc."""
    for sensor in context.components.values():
        if sensor.name() in wishes or getattr(sensor, "visible_arc", False):
            for request in sensor.requests:
                if isinstance(request, RayBundle):
                    request.refresh()


# Sends recorded data of sensors to pages that show a recorded run.


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


# Sends recorded images of cameras to pages that show a recorded run.

#: ns: tolerance for rounded times of messages
_ROUNDING = 1_000_000


class RecordedPicturesFeed(PicturesFeed):
    """Sends the recorded images of cameras; images of cameras that were not recorded are those of the simulation.

    Args:
        context: of the simulation.
        server: the server of the pages.
        fields: the recorded data.
        time: the present time of the recording, s.
        looks: whether cameras that were not recorded have to capture images of the present world, because nothing is
            simulated.
    """

    def __init__(
        self,
        context: Context,
        server: ViewServer,
        fields: RecordedFields,
        time: Callable[[], float],
        *,
        looks: bool = False,
    ) -> None:
        super().__init__(context, server)
        self._fields = fields
        self._time = time
        self._looks = looks
        #: times at which cameras have captured images
        self._last_look: dict[str, float] = {}
        #: log time and image of each camera
        self._shots: dict[str, tuple[int, Shot | None]] = {}

    def shot(self, name: str, component: object) -> Shot | None:
        """The last image of the camera at the present time of the recording."""
        if name not in self._fields:
            return self._present(name, component)
        try:
            fields = self._fields.last(name, round(self._time() * 1e9) + _ROUNDING)
        except RecordingError:  # damaged data: show the image of the simulation instead
            return self._present(name, component)
        if fields is None:
            return None
        entry = self._shots.get(name)
        if entry is None or entry[0] != fields.time:
            entry = self._shots[name] = fields.time, shot_of(component, fields.values)
        if "image" not in fields.values:  # such as a semantic camera
            return self._present(name, component)
        return entry[1]

    def _present(self, name: str, component: object) -> Shot | None:
        """The image of the present world."""
        if self._looks and self._last_look.get(name) != self._time():
            self._last_look[name] = self._time()
            with acting(self._context):
                look_around(component)
        return super().shot(name, component)
