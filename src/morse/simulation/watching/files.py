"""Finds out which of some files have been saved."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable

_Stamp = tuple[int, int, int]


class SavedFiles:
    """Compares the times, sizes and numbers of files with those of the last look.

    A file counts as saved once it has changed and stayed the same from one look to the next: programs write files
    piece by piece. A file that is missing is expected to come back: many programs write a new one and rename it.
    """

    def __init__(self) -> None:
        self._known: dict[str, _Stamp | None] = {}
        self._changing: dict[str, _Stamp] = {}

    def look(self, paths: Iterable[str]) -> list[str]:
        """Those of the files that were saved since they were looked at first or were in this list last."""
        saved = []
        for path in paths:
            stamp = _stamp(path)
            if path not in self._known:
                self._known[path] = stamp
            elif stamp is None or stamp == self._known[path]:
                self._changing.pop(path, None)
            elif self._changing.get(path) == stamp:
                del self._changing[path]
                self._known[path] = stamp
                saved.append(path)
            else:
                self._changing[path] = stamp
        return saved

    def unchanged(self, path: str) -> bool:
        """Whether a file is as it was when `look` named it."""
        return _stamp(path) == self._known.get(path)


def _stamp(path: str) -> _Stamp | None:
    try:
        status = os.stat(path)
    except OSError:
        return None
    return status.st_mtime_ns, status.st_size, status.st_ino
