"""Plugins from installed packages and from the project that runs: components, modifiers, middlewares, models.

A package declares them by entry points in its ``pyproject.toml``::

    [project.entry-points."morse.components"]
    my_lab = "my_lab"

A project, whose ``src`` is on the import path, need not be installed: its ``pyproject.toml`` itself is read.

What entry points name is loaded by `load`, and other code of packages is called by `attempt`: what they raise is a
`PluginError`, for which the caller leaves the package out and names it.
"""

from __future__ import annotations

import logging
import os
import re
import sys
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from morse.core.exceptions import MorseError
from morse.system import OF_MACHINE
from morse.system.regular_files import read_regular

if TYPE_CHECKING:
    from collections.abc import Callable
    from importlib.metadata import Distribution, EntryPoint

_T = TypeVar("_T")

logger = logging.getLogger(__name__)

_SUFFIXES = (".dist-info", ".egg-info")
_NOTHING: tuple[str, tuple[EntryPoint, ...]] = ("", ())


class PluginError(MorseError):
    """What an installed package, or the project, brings cannot be used; the message is the error and its line."""


def load(point: EntryPoint, use: Callable[[Any], _T]) -> _T:
    """Load what an entry point names, and return what ``use`` makes of it: it checks the object, or creates one.

    Raises:
        PluginError: the package cannot be imported, or ``use`` has raised an error; see `attempt`.
    """
    return attempt(lambda: use(point.load()))


def attempt(call: Callable[[], _T]) -> _T:
    """Call code of a package.

    Raises:
        PluginError: it has raised an error of any class. A package that calls ``sys.exit`` ends no program either.
        KeyboardInterrupt: the user ends the program.
    """
    try:
        return call()
    except KeyboardInterrupt:
        raise
    except BaseException as error:
        from morse.core.reports.faults import summary, trace_of, user_frames

        lines = [f" ({frame.filename}:{frame.lineno})" for frame in user_frames(trace_of(error))[-1:]]
        raise PluginError("".join([summary(error), *lines])) from error


def entry_points(group: str) -> tuple[EntryPoint, ...]:
    """Return the entry points of a group, e.g. ``morse.components``, sorted by name.

    Args:
        group: name of the group; it has to begin with ``morse.``.
    """
    # asked for each component of a scene
    sources = [entry for entry in dict.fromkeys(sys.path) if os.path.basename(os.path.normpath(entry)) == "src"]
    projects = [_of_project(Path(entry)) for entry in sources]
    own = [point for _, points in projects for point in points if point.group == group]
    names = {name for name, _ in projects if name}
    # what was installed of a project that runs from its folder may be older than its pyproject.toml
    others = [point for point, package in _found(group, tuple(sys.path)) if package not in names]
    points = dict.fromkeys((*own, *others))
    return tuple(sorted(points, key=lambda point: (point.name, point.value)))


def use_project_here() -> None:
    """Put the sources of the project in the working directory on the import path, at its end, if there is one."""
    project = str(Path("src").absolute())
    if Path("pyproject.toml").is_file() and project not in sys.path:
        sys.path.append(project)


def _normal(name: str) -> str:
    """The name of a package as indexes compare it."""
    return re.sub(r"[-_.]+", "-", name).lower()


def _of_project(source: Path) -> tuple[str, tuple[EntryPoint, ...]]:
    """The name and the entry points of a project with this directory of sources."""
    file = source.parent / "pyproject.toml"
    try:
        return _of_file(file, file.stat().st_mtime_ns)
    except OSError:
        return _NOTHING


@lru_cache(maxsize=32)
def _of_file(file: Path, _changed: int) -> tuple[str, tuple[EntryPoint, ...]]:
    text = read_regular(file)
    if b"morse." not in text:
        return _NOTHING
    import tomllib
    from importlib.metadata import EntryPoint

    try:
        project = tomllib.loads(text.decode("utf-8")).get("project", {})
        table = project.get("entry-points", {})
        return _normal(str(project.get("name", ""))), tuple(
            EntryPoint(str(name), str(value), group)
            for group, points in table.items()
            if group.startswith("morse.")
            for name, value in points.items()
        )
    except (ValueError, AttributeError, RecursionError) as error:
        logger.warning("the entry points in %s are left out: %s", file, error, extra=OF_MACHINE)
        return _NOTHING


@lru_cache(maxsize=32)
def _found(group: str, path: tuple[str, ...]) -> tuple[tuple[EntryPoint, str], ...]:
    """The entry points of a group in the packages on the import path, and the names of these packages."""
    packages: dict[str, tuple[tuple[EntryPoint, str], ...]] = {}
    for directory in dict.fromkeys(path):
        for stem, points in _packages_in(directory):
            # the first one of a name is the one that is imported
            packages.setdefault(stem, points)
    return tuple(pair for points in packages.values() for pair in points if pair[0].group == group)


@lru_cache(maxsize=256)
def _packages_in(directory: str) -> tuple[tuple[str, tuple[tuple[EntryPoint, str], ...]], ...]:
    """The packages in a directory of the import path, by their names in its files: their entry points of MORSE.

    A directory is read once: the import path changes with each scene, and there are a dozen groups.
    """
    if os.path.isfile(directory):  # an archive
        from importlib import metadata

        try:
            packages = [(_distribution(package), package) for package in metadata.distributions(path=[directory])]
        except Exception as error:  # third-party data
            _warn_of_package(f"the entry points in {directory} are left out: {error}")
            return ()
        return tuple((name, _points(package, directory)) for name, package in packages)
    try:
        names = sorted(name for name in os.listdir(directory or ".") if name.endswith(_SUFFIXES))
    except OSError:
        return ()
    return tuple((_normal(Path(name).stem.partition("-")[0]), _of_folder(Path(directory, name))) for name in names)


def _of_folder(folder: Path) -> tuple[tuple[EntryPoint, str], ...]:
    # avoids importing importlib.metadata (30 ms) if no package has such entry points
    try:
        if b"[morse." not in read_regular(folder / "entry_points.txt"):
            return ()
    except OSError:
        return ()
    from importlib import metadata

    return _points(metadata.Distribution.at(folder), str(folder))


def _points(package: Distribution, place: str) -> tuple[tuple[EntryPoint, str], ...]:
    try:
        name = _distribution(package)
        return tuple((point, name) for point in package.entry_points if point.group.startswith("morse."))
    except Exception as error:  # third-party data: a broken package hides no others
        _warn_of_package(f"the entry points in {place} are left out: {error}")
        return ()


def _distribution(package: Distribution) -> str:
    """The name of an installed package; empty if it is unknown."""
    # the folder of a package that was half removed has no name
    return _normal(str(package.name or ""))


@lru_cache(maxsize=32)
def _warn_of_package(text: str) -> None:
    logger.warning("%s", text, extra=OF_MACHINE)
