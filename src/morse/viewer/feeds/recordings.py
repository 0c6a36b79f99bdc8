"""Sends pages the active recordings."""

from __future__ import annotations

import os
import time
from typing import TYPE_CHECKING

from morse.services.recording_services import RecordingServices
from morse.viewer.view_messages import RecordingDescription, Recordings

if TYPE_CHECKING:
    from morse.recording.recorder import Recorder
    from morse.simulation.simulation import Simulation
    from morse.viewer.server import ViewServer

#: wall-clock seconds between two checks of the sizes of files
_INTERVAL = 0.5


class RecordingsFeed:
    """Sends path, duration and size of the recordings.

    Args:
        simulation: whose recordings are described.
        possible: whether the page may start a recording.
    """

    def __init__(self, simulation: Simulation, server: ViewServer, *, possible: bool = True) -> None:
        self._simulation = simulation
        self._server = server
        self._possible = possible
        self._last_look = 0.0
        self._last_message: Recordings | None = None

    def update(self) -> None:
        """Send the changes since the last call."""
        recorders = self._simulation.recorders
        now = time.monotonic()
        paths = [] if self._last_message is None else [one.path for one in self._last_message.recordings]
        if now - self._last_look < _INTERVAL and paths == [recorder.path for recorder in recorders]:
            return
        self._last_look = now
        services = self._simulation.context.service_objects
        stoppable = {one.path for one in services if isinstance(one, RecordingServices)}
        descriptions = [self._describe(recorder, recorder.path in stoppable) for recorder in recorders]
        message = Recordings(descriptions, self._possible)
        if message != self._last_message:
            self._last_message = message
            self._server.send(message)

    def _describe(self, recorder: Recorder, stoppable: bool) -> RecordingDescription:
        try:
            size = os.stat(recorder.path).st_size
        except OSError:  # the file was removed
            size = 0
        return RecordingDescription(recorder.path, recorder.ticks / self._simulation.clock.frequency, size, stoppable)
