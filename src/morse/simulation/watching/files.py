"""Detects which files have been saved."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable

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
