"""Results on disk that can be computed again: one directory per user, one file per result."""

from __future__ import annotations

import contextlib
import os
import stat
import sys
import tempfile
from pathlib import Path

from morse.system import variables

#: flags for opening files that may be anything; Windows has neither
_CAREFUL = getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_BINARY", 0)


class Cache:
    """A directory of results, in the cache directory of the system or in ``MORSE_CACHE``.

    A cache never raises errors: a result that cannot be read counts as missing, and a result that cannot be written is
    not stored. Directories and files of other users are not used.

    Args:
        kind: name of the directory and of the kind of results.
        most: maximum number of results; if there are more, the least recently used ones are deleted, once per process.
    """

    def __init__(self, kind: str, most: int) -> None:
        self._kind = kind
        self._most = most
        self._is_tidy = False

    def get(self, key: str, largest: int = 1 << 30) -> bytes | None:
        """The data stored under a key; None if there are none, or more than the given number of bytes."""
        folder = self._folder()
        if folder is None:
            return None
        file = folder / key
        try:
            if not _is_own(folder.stat()):
                return None
            # a pipe must not block, and a link must not lead to an endless file
            descriptor = os.open(file, os.O_RDONLY | _CAREFUL)
            with open(descriptor, "rb") as stream:
                status = os.fstat(descriptor)
                if not (stat.S_ISREG(status.st_mode) and _is_own(status) and status.st_size <= largest):
                    return None
                data = stream.read(largest)
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
            if not _is_own(folder.stat()):
                return
            with tempfile.NamedTemporaryFile(dir=folder, prefix=".", delete=False) as file:
                try:
                    file.write(data)
                    file.close()
                    os.replace(file.name, folder / key)
                except BaseException:
                    os.unlink(file.name)
                    raise
            if not self._is_tidy:
                self._is_tidy = True
                self._tidy(folder)
        except OSError:
            return

    def _tidy(self, folder: Path) -> None:
        with os.scandir(folder) as entries:
            files = [(entry.stat().st_mtime_ns, entry.path) for entry in entries if entry.is_file()]
        for _, path in sorted(files)[: max(len(files) - self._most, 0)]:
            with contextlib.suppress(FileNotFoundError):  # the file was deleted by another process
                os.unlink(path)

    def _folder(self) -> Path | None:
        folder = variables.text("MORSE_CACHE")
        if folder == "off":
            return None
        try:
            return (Path(folder) if folder else _system_folder() / "morse") / self._kind
        except RuntimeError:  # the user has no home directory
            return None


def _is_own(status: os.stat_result) -> bool:
    """Whether a file or a directory belongs to the user or to the system; others could have put wrong results there."""
    return not hasattr(os, "geteuid") or status.st_uid in (0, os.geteuid())


def _system_folder() -> Path:
    if sys.platform == "win32":
        return Path(os.environ.get("LOCALAPPDATA") or Path.home() / "AppData" / "Local")
    if sys.platform == "darwin":
        return Path.home() / "Library" / "Caches"
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
