"""Reads files that may be anything (a pipe or a device would block, or never end), and finds the folders above them."""

from __future__ import annotations

import contextlib
import errno
import os
import stat
import sys
import tempfile
import time
from contextlib import contextmanager
from contextvars import ContextVar
from itertools import takewhile
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO, TypeVar

if TYPE_CHECKING:
    from collections.abc import Callable, Hashable, Iterator
    from os import stat_result

    from morse.system.workers import Worker


#: bytes that are read from files; each file of a model is read one to three times
MOST_BYTES = 8 << 30
#: pixels of pictures that are decoded, each by its cost; about 10 ns each
MOST_PIXELS = 1 << 31
#: files that are searched by different names, each in about 0.5 ms
MOST_SEARCHES = 20_000
#: wall-clock time for pictures that a process decodes, all and one of them, s; its memory, bytes
MOST_SECONDS, PATIENCE, MOST_MEMORY = 40.0, 15.0, 512 << 20
_Result = TypeVar("_Result")
_DECODER = "morse.system.pictures"


class BudgetError(ValueError):
    """The parts of a file cost more than one file may; the message says which."""


class Budget:
    """What remains for the parts of a file."""

    def __init__(self) -> None:
        self._bytes, self._pixels, self._seconds = MOST_BYTES, MOST_PIXELS, MOST_SECONDS
        self._decoder: Worker | None = None
        self._searches = MOST_SEARCHES
        self._known: dict[tuple[Hashable, ...], Any] = {}

    def once(self, key: tuple[Hashable, ...], make: Callable[[], object]) -> Any:
        """The result of a function, which is called once for each key."""
        if key not in self._known:
            self._known[key] = make()
        return self._known[key]

    def take_search(self) -> None:
        """Count a file that is searched.

        Raises:
            BudgetError: there are too many.
        """
        self._searches -= 1
        if self._searches < 0:
            raise BudgetError(f"the model refers to more than {MOST_SEARCHES:,} files")

    def take_bytes(self, count: int) -> None:
        """Count bytes that are read.

        Raises:
            BudgetError: there are too many.
        """
        self._bytes -= count
        if self._bytes < 0:
            raise BudgetError(f"the files of the model have more than {MOST_BYTES >> 30} GiB together")

    def take_pixels(self, count: int) -> None:
        """Count pixels that are decoded.

        Raises:
            BudgetError: there are too many.
        """
        self._pixels -= count
        if self._pixels < 0:
            raise BudgetError(f"the pictures of the model have more than {MOST_PIXELS} pixels together")

    def decoded(self, data: bytes) -> bytes:
        """The answer of `morse.system.pictures` to the content of a file.

        Raises:
            BudgetError: its process has ended: it has needed too much time or memory.
            OSError: it cannot be started.
        """
        if self._seconds <= 0.0:
            raise BudgetError(f"decoding the pictures of the model takes more than {MOST_SECONDS:g} s")
        # imported on demand, because few files have such pictures
        from morse.system.workers import Worker, WorkerError, bare_environment

        if self._decoder is None:
            self._decoder = Worker.program(_DECODER, bare_environment(), is_silent=True)
        begin = time.monotonic()
        try:
            return self._decoder.ask(data, PATIENCE)
        except WorkerError:
            self.close()
            raise BudgetError(f"decoding it takes more than {PATIENCE:g} s, or more memory than it may") from None
        finally:
            self._seconds -= time.monotonic() - begin

    def close(self) -> None:
        """End the process that decodes."""
        if self._decoder is not None:
            self._decoder.close()
            self._decoder = None


_budget: ContextVar[Budget | None] = ContextVar("budget", default=None)


@contextmanager
def budget_of_file() -> Iterator[Budget]:
    """The budget of the file that is being read; within the block, files that are read as its parts share it."""
    present = _budget.get()
    if present is not None:
        yield present
        return
    budget = Budget()
    token = _budget.set(budget)
    try:
        yield budget
    finally:
        _budget.reset(token)
        budget.close()


def take_bytes(count: int) -> None:
    """Count bytes that are read for the file that is being read, if there is one; see `Budget.take_bytes`."""
    budget = _budget.get()
    if budget is not None:
        budget.take_bytes(count)


def take_search() -> None:
    """Count a file that is searched for the file that is being read, if there is one; see `Budget.take_search`."""
    budget = _budget.get()
    if budget is not None:
        budget.take_search()


def once_for_file(make: Callable[[], _Result], *key: Hashable) -> _Result:
    """The result of a search: for one file that is read, with all its parts, the disk is searched once for each key."""
    budget = _budget.get()
    if budget is None:
        return make()
    result: _Result = budget.once(key, make)
    return result


#: largest file of source code or of settings, bytes; Python takes 0.3 s and 0.3 GB to compile a megabyte
SOURCE_LIMIT = 2 << 20
#: flags with which opening does not wait for the other end of a pipe; Windows has neither
_FLAGS = os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0) | getattr(os, "O_CLOEXEC", 0)
_UNITS = ((1 << 20, "MiB"), (1 << 10, "KiB"), (1, "bytes"))


class RefusedFileError(OSError):
    """A file is not read; the message contains its path and the reason."""

    def __str__(self) -> str:
        return f"{self.filename}: {self.strerror}"


def open_regular(path: str | Path, most: int = sys.maxsize) -> BinaryIO:
    """Open a regular file for reading, without waiting.

    Args:
        path: the file; symbolic links are followed.
        most: maximum size, bytes.

    Raises:
        OSError: it does not exist, is a directory, a pipe, a socket or a device, or is too large; ``strerror`` is a
            sentence for the user.
    """
    # devices are not even opened, because that may have an effect
    _check(path, os.stat(path), most)
    descriptor = os.open(path, _FLAGS)
    try:
        _check(path, os.fstat(descriptor), most)
        return open(descriptor, "rb")
    except BaseException:
        os.close(descriptor)
        raise


def read_regular(path: str | Path, most: int = SOURCE_LIMIT) -> bytes:
    """Return the content of a regular file, which counts for the model that is being read; see `open_regular`."""
    with open_regular(path, most) as file:
        # a read of a number of bytes takes so much memory
        content = file.read() if most == sys.maxsize else file.read(most + 1)
    if len(content) > most:
        raise _too_large(path, most)
    try:
        take_bytes(len(content))
    except BudgetError as error:
        raise RefusedFileError(errno.EFBIG, str(error), str(path)) from None
    return content


def check_default_name(path: Path) -> None:
    """Check a file that is written under a name that the user has not chosen, before it is opened.

    A folder that somebody has sent may have a link of this name, which leads to a file of the user.

    Raises:
        RefusedFileError: there is something else than a file with this one name.
    """
    try:
        status = os.lstat(path)
    except FileNotFoundError:
        return
    what = ""
    if stat.S_ISLNK(status.st_mode):
        what = "a symbolic link"
    elif not is_regular(status):
        what = "a folder" if stat.S_ISDIR(status.st_mode) else _kind(status.st_mode)
    elif status.st_nlink > 1:
        what = "a file with several names (hard links)"
    if what:
        raise RefusedFileError(errno.EEXIST, f"it is {what}, and is not written: give another name", str(path))


def is_regular(status: stat_result) -> bool:
    """Whether a file has content of a certain size: it is not a directory, pipe, socket or device."""
    return stat.S_ISREG(status.st_mode)


def _check(path: str | Path, status: stat_result, most: int) -> None:
    if stat.S_ISDIR(status.st_mode):
        raise IsADirectoryError(errno.EISDIR, "it is a directory", str(path))
    if not is_regular(status):
        raise RefusedFileError(errno.EINVAL, f"it is {_kind(status.st_mode)}, expected a regular file", str(path))
    if status.st_size > most:
        raise _too_large(path, most)


def _kind(mode: int) -> str:
    if stat.S_ISFIFO(mode):
        return "a pipe"
    return "a socket" if stat.S_ISSOCK(mode) else "a device"


def _too_large(path: str | Path, most: int) -> OSError:
    size, unit = next(((size, unit) for size, unit in _UNITS if most >= size), _UNITS[-1])
    return RefusedFileError(errno.EFBIG, f"it is larger than {most // size} {unit}", str(path))


def home() -> Path | None:
    """The home folder of the user; None if it has none, as in a container that runs as a number."""
    with contextlib.suppress(RuntimeError):
        return Path.home()
    return None


def expanded(name: str | os.PathLike[str]) -> Path:
    """A path with ``~`` and ``~user`` replaced; as it is if there is no such user, since a name may begin so."""
    with contextlib.suppress(RuntimeError):
        return Path(name).expanduser()
    return Path(name)


def _temporary_folders() -> set[str]:
    """Folders of temporary files: the usual ones, and that of Python, which has none if nothing can be written."""
    folders = {os.environ.get(name, "") for name in ("TMPDIR", "TEMP", "TMP")} | {"/tmp", "/var/tmp", "/usr/tmp"}
    with contextlib.suppress(OSError):
        folders.add(tempfile.gettempdir())
    return {folder for folder in folders if folder and os.path.isabs(folder)}


def folders_above(path: Path) -> list[Path]:
    """The folders above a file, the nearest first: up to the home folder, that of temporary files, or the root."""
    shared = {Path(os.path.realpath(path.absolute().anchor))}
    if (own := home()) is not None:
        shared.add(Path(os.path.realpath(own)))
    shared |= {Path(os.path.realpath(folder)) for folder in _temporary_folders()}
    shared |= {folder for one in shared for folder in one.parents}
    return list(takewhile(lambda folder: Path(os.path.realpath(folder)) not in shared, path.absolute().parents))
