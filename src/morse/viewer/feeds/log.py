"""Shows pages the lines of the log, and the component of each line."""

from __future__ import annotations

import logging
import os
import threading
import time
from collections import deque
from typing import TYPE_CHECKING, Literal

from morse.core.observer import SHOWN
from morse.services.recording_services import RecordingServices
from morse.viewer.view_messages import Log, RecordingDescription, Recordings

if TYPE_CHECKING:
    from morse.core.context import Context
    from morse.recording.recorder import Recorder
    from morse.simulation.simulation import Simulation
    from morse.viewer.server import ViewServer


#: number of lines that are kept for later pages
KEPT = 300
#: maximum number of characters of a line
_LENGTH = 4000

_Level = Literal["debug", "info", "warning", "error"]


class LogFeed(logging.Handler):
    """Sends the log of the simulator to the pages.

    Lines may come from any thread; `update` sends them in the simulation thread. Lines that another simulation of this
    process logs in its own thread are omitted.
    """

    def __init__(self, context: Context, server: ViewServer) -> None:
        super().__init__(logging.INFO)
        self._context = context
        self._server = server
        self._lines: deque[tuple[logging.LogRecord, float]] = deque(maxlen=KEPT)
        self._number = 0
        self._thread = threading.get_ident()
        self._log = logging.getLogger("morse")
        self._log.addHandler(self)

    def emit(self, record: logging.LogRecord) -> None:
        """Keep a line until the end of the tick."""
        if record.thread == self._thread or record.threadName == _NETWORK:
            self._lines.append((record, self._time()))

    def update(self) -> None:
        """Send the lines logged since the last call."""
        self._thread = threading.get_ident()
        while self._lines:
            record, time = self._lines.popleft()
            try:
                text = record.getMessage()
            except Exception:  # arguments may be of any type
                text = str(record.msg)
            line = self._number % KEPT
            self._number += 1
            text, component = printable(text[:_LENGTH]), self._component(record)
            is_shown = getattr(record, SHOWN, False)
            self._server.send(Log(_level(record.levelno), text, component, time, line, is_shown))

    def _time(self) -> float:
        return self._context.clock.time

    def _component(self, record: logging.LogRecord) -> str:
        """The component that a line names, or an empty string."""
        arguments = record.args if isinstance(record.args, tuple) else ()
        for argument in arguments:
            # messages such as "robot.motion: a message is refused" contain the name, too
            name = argument.partition(":")[0] if isinstance(argument, str) else ""
            if name in self._context.components or name in self._context.robots:
                return name
        return ""

    def close(self) -> None:
        """Stop listening."""
        self._log.removeHandler(self)
        super().close()


#: name of the thread that serves connections, see `morse.core.clients.network`
_NETWORK = "morse-network"

#: characters that change the text direction
_TURNING = frozenset(chr(code) for code in (*range(0x202A, 0x202F), *range(0x2066, 0x206A), 0x200E, 0x200F, 0x061C))


def printable(text: str) -> str:
    """The text with control characters, other than line ends and tabs, written as escapes."""
    return "".join(c if _is_plain(c) else c.encode("unicode_escape").decode() for c in text)


def _is_plain(character: str) -> bool:
    return (character.isprintable() or character in "\n\t") and character not in _TURNING


def _level(number: int) -> _Level:
    if number >= logging.ERROR:
        return "error"
    if number >= logging.WARNING:
        return "warning"
    return "info" if number >= logging.INFO else "debug"


# Sends pages the active recordings.

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
