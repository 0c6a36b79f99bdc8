"""Plugins from installed packages and from the project that runs: components, modifiers, middlewares, models.

A package declares them by entry points in its ``pyproject.toml``::

    [project.entry-points."morse.components"]
    my_lab = "my_lab"

A project, whose ``src`` is on the import path, need not be installed: its ``pyproject.toml`` itself is read.
"""

from __future__ import annotations

import logging
import os
import sys
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING

from morse.system import OF_MACHINE
from morse.system.regular_files import read_regular

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint

logger = logging.getLogger(__name__)

_SUFFIXES = (".dist-info", ".egg-info")


def entry_points(group: str) -> tuple[EntryPoint, ...]:
    """Return the entry points of a group, e.g. ``morse.components``, sorted by name.

    Args:
        group: name of the group; it has to begin with ``morse.``.
    """
    own = [point for entry in dict.fromkeys(sys.path) for point in _of_project(Path(entry)) if point.group == group]
    points = dict.fromkeys((*own, *_found(group, tuple(sys.path))))
    return tuple(sorted(points, key=lambda point: (point.name, point.value)))


def _of_project(source: Path) -> tuple[EntryPoint, ...]:
    """The entry points of a project with this directory of sources."""
    file = source.parent / "pyproject.toml"
    if source.name != "src":
        return ()
    try:
        return _of_file(file, file.stat().st_mtime_ns)
    except OSError:
        return ()


@lru_cache(maxsize=32)
def _of_file(file: Path, _changed: int) -> tuple[EntryPoint, ...]:
    text = read_regular(file)
    if b"morse." not in text:
        return ()
    import tomllib
    from importlib.metadata import EntryPoint

    try:
        table = tomllib.loads(text.decode("utf-8")).get("project", {}).get("entry-points", {})
        return tuple(
            EntryPoint(str(name), str(value), group)
            for group, points in table.items()
            if group.startswith("morse.")
            for name, value in points.items()
        )
    except (ValueError, AttributeError) as error:
        logger.warning("the entry points in %s are left out: %s", file, error, extra=OF_MACHINE)
        return ()


@lru_cache(maxsize=32)
def _found(group: str, path: tuple[str, ...]) -> tuple[EntryPoint, ...]:
    # avoids importing importlib.metadata (30 ms) if no package has such entry points
    if not any(_mentions(group, Path(entry)) for entry in dict.fromkeys(path)):
        return ()
    from importlib import metadata

    return tuple(set(metadata.entry_points(group=group)))


@lru_cache(maxsize=256)
def _mentions(group: str, directory: Path) -> bool:
    """Whether a package in a directory of the import path has entry points of a group."""
    if directory.is_file():
        return True  # an archive, which importlib.metadata can read
    try:
        names = [name for name in os.listdir(directory) if name.endswith(_SUFFIXES)]
    except OSError:
        return False
    return any(_declares(group, directory / name / "entry_points.txt") for name in names)


def _declares(group: str, file: Path) -> bool:
    try:
        return f"[{group}]".encode() in read_regular(file)
    except OSError:
        return False
