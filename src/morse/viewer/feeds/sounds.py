"""Sends pages the sounds of loudspeakers of robots."""

from __future__ import annotations

import logging
from pathlib import Path
from typing import TYPE_CHECKING

from morse.actuators.sound import Sound
from morse.core.reports.quoting import shown
from morse.system.regular_files import read_regular
from morse.viewer.view_messages import SoundState

if TYPE_CHECKING:
    from collections.abc import Iterable

    from morse.core.context import Context
    from morse.viewer.server import ViewServer

logger = logging.getLogger("morse.viewer")

#: maximum size of a sound file, bytes; a larger file is not sent
LARGEST = 32 << 20
#: signatures of sound files: offset, bytes, content type
_BEGINNINGS = (
    (8, b"WAVE", "audio/wav"),
    (0, b"OggS", "audio/ogg"),
    (0, b"fLaC", "audio/flac"),
    (0, b"ID3", "audio/mpeg"),
    (0, b"\xff\xfb", "audio/mpeg"),
    (0, b"\xff\xf3", "audio/mpeg"),
    (4, b"ftyp", "audio/mp4"),
    (0, b"\x1aE\xdf\xa3", "audio/webm"),
)


class SoundsFeed:
    """Sends the sounds of the actuators `morse.actuators.sound.Sound`.

    Only files that the scene script names are read: clients may set the property ``file`` to any path of this machine,
    and the page must not make it readable.
    """

    def __init__(self, context: Context, server: ViewServer) -> None:
        self._context = context
        self._server = server
        self._last_states: dict[str, tuple[str, str]] = {}
        self._addresses: dict[str, str | None] = {}
        self._speakers: list[Sound] = []
        self._file_names: frozenset[str] = frozenset()
        self.restarted()

    def restarted(self) -> None:
        """The components were created again."""
        self._speakers = [one for one in self._context.components.values() if isinstance(one, Sound)]
        if self._speakers:
            self._file_names |= frozenset(named_files(self._context))

    def update(self) -> None:
        """Send the changes since the last call."""
        for speaker in self._speakers:
            name, state = speaker.name(), (speaker.mode, speaker.file)
            if self._last_states.get(name) != state:
                self._last_states[name] = state
                self._server.send(
                    SoundState(name, speaker.mode, self._address(name, speaker.file), speaker.played, self._now())
                )

    def _now(self) -> float:
        return self._context.clock.time

    def _address(self, name: str, file: str) -> str | None:
        if not file:
            return None
        if file not in self._file_names:
            # clients may set any number of long names: none of them is kept
            text = f"{name}: the scene script does not name {shown(file)}: pages play a tone"
            self._context.complaints.warn(f"{name}: sound", text)
            return None
        if file not in self._addresses:
            self._addresses[file] = self._offered(name, file)
        return self._addresses[file]

    def _offered(self, name: str, file: str) -> str | None:
        try:
            kind, data = read_sound(Path(file))
        except (OSError, ValueError) as error:
            reason = error.strerror if isinstance(error, OSError) else error
            logger.warning("%s: %s is not sent to pages, which play a tone: %s", name, shown(file), reason)
            return None
        return self._server.offer("sounds", kind, data)


def named_files(context: Context) -> Iterable[str]:
    """The files of the actuators in the scene script."""
    for component in context.scene.components:
        file = component.node.properties.get("file")
        if isinstance(file, str):
            yield file


def read_sound(path: Path) -> tuple[str, bytes]:
    """The content type and the bytes of a sound file.

    Raises:
        OSError: the file cannot be read.
        ValueError: the file is too large, or of another format.
    """
    if not path.is_file():
        raise ValueError("there is no such file")
    data = read_regular(path, LARGEST)
    for offset, beginning, kind in _BEGINNINGS:
        if data[offset : offset + len(beginning)] == beginning:
            return kind, data
    raise ValueError("the file is not WAV, Ogg, FLAC, MP3, MP4 or WebM")
