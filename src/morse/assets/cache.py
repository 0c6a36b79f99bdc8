"""Results on disk that can be computed again: one directory per user, one file per result."""

from __future__ import annotations

import contextlib
import os
import sys
import tempfile
from pathlib import Path


class Cache:
    """A directory of results, in the cache directory of the system or in ``MORSE_CACHE``.

    A cache never raises errors: a result that cannot be read counts as missing, and a result that cannot be written is
    not stored.

    Args:
        kind: name of the directory and of the kind of results.
        most: maximum number of results; if there are more, the least recently used ones are deleted, once per process.
    """

    def __init__(self, kind: str, most: int) -> None:
        self._kind = kind
        self._most = most
        self._tidied = False

    def get(self, key: str, largest: int = 1 << 30) -> bytes | None:
        """The data stored under a key; None if there are none, or more than the given number of bytes."""
        folder = self._folder()
        if folder is None:
            return None
        file = folder / key
        try:
            if file.stat().st_size > largest:
                return None
            data = file.read_bytes()
        except OSError:
            return None
        with contextlib.suppress(OSError):
            os.utime(file)  # marks the result as the one that was used last, so that it is the last one to be deleted
        return data

    def put(self, key: str, data: bytes) -> None:
        """Store data under a key."""
        folder = self._folder()
        if folder is None:
            return
        try:
            folder.mkdir(parents=True, exist_ok=True, mode=0o700)
            with tempfile.NamedTemporaryFile(dir=folder, prefix=".", delete=False) as file:
                try:
                    file.write(data)
                    file.close()
                    os.replace(file.name, folder / key)
                except BaseException:
                    os.unlink(file.name)
                    raise
            if not self._tidied:
                self._tidied = True
                self._tidy(folder)
        except OSError:
            return

    def _tidy(self, folder: Path) -> None:
        with os.scandir(folder) as entries:
            found = [(entry.stat().st_mtime_ns, entry.path) for entry in entries if entry.is_file()]
        for _, path in sorted(found)[: max(len(found) - self._most, 0)]:
            with contextlib.suppress(FileNotFoundError):  # the file was deleted by another process
                os.unlink(path)

    def _folder(self) -> Path | None:
        given = os.environ.get("MORSE_CACHE", "")
        if given == "off":
            return None
        try:
            return (Path(given) if given else _system_folder() / "morse") / self._kind
        except RuntimeError:  # the user has no home directory
            return None


def _system_folder() -> Path:
    if sys.platform == "win32":
        return Path(os.environ.get("LOCALAPPDATA") or Path.home() / "AppData" / "Local")
    if sys.platform == "darwin":
        return Path.home() / "Library" / "Caches"
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
