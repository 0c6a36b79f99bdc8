"""Reads files that may be anything: a pipe or a device would block, or never end."""

from __future__ import annotations

import errno
import os
import stat
import sys
from typing import TYPE_CHECKING, BinaryIO

from morse.system.budget import BudgetError, take_bytes

if TYPE_CHECKING:
    from os import stat_result
    from pathlib import Path

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
    """Whether a file has content of a certain size: it is no directory, pipe, socket or device."""
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
