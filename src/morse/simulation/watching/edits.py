"""Files that were saved while the simulation runs, and are not in use as they are now."""

from __future__ import annotations

import os
import re
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence


# Detects which files have been saved.

_Stamp = tuple[int, int, int]


class SavedFiles:
    """Compares the modification times, sizes and inode numbers of files with those of the last check.

    A file counts as saved when it has changed and then stays the same between two checks, because programs write files
    in pieces. A missing file is expected to reappear, because many programs write a new file and rename it.
    """

    def __init__(self) -> None:
        self._stamps: dict[str, _Stamp | None] = {}
        self._changing: dict[str, _Stamp] = {}

    def look(self, paths: Iterable[str]) -> list[str]:
        """Return the files that were saved since the first check, or since they were last returned."""
        news = []
        for path in paths:
            stamps = stamp(path)
            if path not in self._stamps:
                self._stamps[path] = stamps
            elif stamps is None or stamps == self._stamps[path]:
                self._changing.pop(path, None)
            elif self._changing.get(path) == stamps:
                del self._changing[path]
                self._stamps[path] = stamps
                news.append(path)
            else:
                self._changing[path] = stamps
        return news

    def unchanged(self, path: str) -> bool:
        """Whether a file is unchanged since `look` returned it."""
        return stamp(path) == self._stamps.get(path)


def stamp(path: str) -> _Stamp | None:
    """Return the modification time (ns), size (bytes) and inode number of a file; None if the file is missing."""
    try:
        status = os.stat(path)
    except OSError:
        return None
    return status.st_mtime_ns, status.st_size, status.st_ino


#: the lines of an error in user code, and the beginning of an error of a scene script
_PLACES = (re.compile(r'File "([^"\n]+)", line (\d+)'), re.compile(r"^(?:.*: )?([^\n:]+\.py):(\d+): ", re.MULTILINE))


class Mistake(NamedTuple):
    """Why a file cannot be used.

    Attributes:
        path: the file with the error.
        line: number of the line; 0 if it is not known.
        text: the error, one line.
    """

    path: str
    line: int
    text: str


class Edits:
    """The present mistakes, and what waits for a restart.

    Attributes:
        mistakes: by the path of the file that was saved.
        waiting: files that are read when the simulation is restarted, in the order in which they were saved.
    """

    def __init__(self) -> None:
        self.mistakes: dict[str, Mistake] = {}
        self.waiting: dict[str, None] = {}
        self._own: dict[str, bytes] = {}
        self._refused: dict[str, object] = {}

    def write(self, path: str, content: bytes) -> None:
        """The simulation itself has saved a file, which describes what it already shows."""
        self._own[path] = content

    def in_use(self, path: str, content: bytes) -> bool:
        """Whether a file contains what the simulation itself has saved, so that it need not be read again."""
        return self._own.get(path) == content

    def was_refused(self, path: str) -> bool:
        """Whether a file is as it was when a restart refused it, so that it neither waits nor is in use."""
        return path in self._refused and self._refused[path] == stamp(path)

    def refuse_at_restart(self, paths: Sequence[str], stamps: Mapping[str, object], reason: str) -> None:
        """Saved files were read by a restart, and have an error.

        Args:
            stamps: those of the files when they were read.
        """
        for path in paths:
            self.take(path)
            self._refused[path] = stamps[path]
        self.refuse(paths[0], reason)

    def refuse(self, path: str, reason: str) -> None:
        """A saved file has an error."""
        places = [place for pattern in _PLACES for place in pattern.findall(reason)]
        file, line = places[-1] if places else (path, "0")
        # an error of a scene script begins with its place
        text = re.sub(r"^[^\n:]+\.py:\d+: ", "", reason.partition("\n")[0])
        self.mistakes[path] = Mistake(file, int(line), text)

    def take(self, path: str, *, waits: bool = False) -> None:
        """A saved file is in use, or waits for the next restart."""
        self.mistakes.pop(path, None)
        self.waiting.pop(path, None)
        if waits:
            self.waiting[path] = None
