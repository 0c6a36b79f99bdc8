"""Plugins from installed packages: components, modifiers, middlewares, models.

A package declares them by entry points in its ``pyproject.toml``::

    [project.entry-points."morse.components"]
    my_lab = "my_lab"
"""

from __future__ import annotations

import os
import sys
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint

_SUFFIXES = (".dist-info", ".egg-info")


def entry_points(group: str) -> tuple[EntryPoint, ...]:
    """Return the entry points of a group, e.g. ``morse.components``, sorted by name.

    Args:
        group: name of the group; it has to begin with ``morse.``.
    """
    return _found(group, tuple(sys.path))


@lru_cache(maxsize=32)
def _found(group: str, path: tuple[str, ...]) -> tuple[EntryPoint, ...]:
    # avoids importing importlib.metadata (30 ms) if no package has such entry points
    if not any(_mentions_us(Path(entry)) for entry in dict.fromkeys(path)):
        return ()
    from importlib import metadata

    return tuple(sorted(set(metadata.entry_points(group=group)), key=lambda point: (point.name, point.value)))


@lru_cache(maxsize=256)
def _mentions_us(directory: Path) -> bool:
    """Whether a package in a directory of the import path has entry points for MORSE."""
    if directory.is_file():
        return True  # an archive, which importlib.metadata can read
    try:
        names = [name for name in os.listdir(directory) if name.endswith(_SUFFIXES)]
    except OSError:
        return False
    return any(_declares(directory / name / "entry_points.txt") for name in names)


def _declares(file: Path) -> bool:
    try:
        return b"[morse." in file.read_bytes()
    except OSError:
        return False
