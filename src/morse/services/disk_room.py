"""Files of clients: clients must not fill the disk of the user."""

from __future__ import annotations

import os
import shutil
from pathlib import Path

from morse.core.exceptions import MorseRPCInvokationError

LEAST = 256 << 20
"""Free bytes on the disk below which clients may not create files."""


def file_of(name: str) -> Path:
    """The path of a file in the folder in which the simulation was started.

    Raises:
        MorseRPCInvokationError: the folder was deleted.
    """
    try:
        return Path(name).absolute()
    except OSError:  # the system does not know the path of the folder any more
        raise MorseRPCInvokationError(
            f"the folder in which the simulation was started was deleted, so that there is no place for {name}"
        ) from None


def check_room(path: Path) -> None:
    """Check that a client may create a file.

    Raises:
        MorseRPCInvokationError: the disk is almost full.
    """
    try:
        free = shutil.disk_usage(os.path.dirname(path)).free
    except OSError:
        return  # the file cannot be created either, which is reported then
    if free < LEAST:
        raise MorseRPCInvokationError(
            f"{path.name} is not written: only {free >> 20} MB are free on the disk, expected at least {LEAST >> 20} MB"
        )
