"""Folders that hold files of all kinds: nothing in them belongs to a project or a model because of its place."""

from __future__ import annotations

import contextlib
import os
import tempfile
from itertools import takewhile
from pathlib import Path


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
