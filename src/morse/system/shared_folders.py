"""Folders that hold files of all kinds: nothing in them belongs to a project or a model because of its place."""

from __future__ import annotations

import contextlib
import os
import tempfile
from itertools import takewhile
from pathlib import Path


def folders_above(path: Path) -> list[Path]:
    """The folders above a file, the nearest first: up to the home folder, that of temporary files, or the root."""
    shared = {Path(os.path.realpath(path.absolute().anchor))}
    with contextlib.suppress(RuntimeError):  # a user without a home
        shared.add(Path(os.path.realpath(Path.home())))
    with contextlib.suppress(OSError):  # no folder can be written
        shared.add(Path(os.path.realpath(tempfile.gettempdir())))
    shared |= {folder for one in shared for folder in one.parents}
    return list(takewhile(lambda folder: Path(os.path.realpath(folder)) not in shared, path.absolute().parents))
