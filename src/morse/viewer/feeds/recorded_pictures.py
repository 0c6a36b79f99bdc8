"""Sends recorded images of cameras to pages that show a recorded run."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.core.context import acting
from morse.recording.errors import RecordingError
from morse.viewer.feeds.pictures import PicturesFeed, Shot, shot_of
from morse.viewer.feeds.recorded_world import look_around

if TYPE_CHECKING:
    from collections.abc import Callable

    from morse.core.context import Context
    from morse.recording.fields.reading import RecordedFields
    from morse.viewer.server import ViewServer

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
