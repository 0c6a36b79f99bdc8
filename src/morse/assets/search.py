"""Search for model files."""

from __future__ import annotations

import difflib
import importlib.util
import itertools
import logging
import os
from contextlib import contextmanager
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING

from morse.assets.formats import is_model, model_format, suffixes
from morse.core.classes.plugins import PluginError, attempt, entry_points
from morse.system import OF_MACHINE, variables
from morse.system.regular_files import expanded

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

logger = logging.getLogger(__name__)

#: directory of the models that are part of MORSE: ``robots``, ``environments``, ``props``, ...
MORSE_COMPONENTS = str(Path(__file__).resolve().parents[1] / "data")

#: variables of Gazebo that list folders of models
MODEL_PATHS = (
    "GZ_SIM_RESOURCE_PATH", "IGN_GAZEBO_RESOURCE_PATH", "GAZEBO_MODEL_PATH", "GAZEBO_RESOURCE_PATH", "SDF_PATH",
)  # fmt: skip

_project_dirs: list[Path] = []

_MAX_ENTRIES = 20_000


class AssetNotFoundError(FileNotFoundError):
    """There is no model file of that name; the message lists the searched directories."""


def set_project_dirs(directories: Iterable[str | Path]) -> None:
    """Search these directories before those of ``MORSE_RESOURCE_PATH`` (``<project>/data``)."""
    _project_dirs[:] = [Path(directory) for directory in directories]


@contextmanager
def project_dirs(directories: Iterable[str | Path]) -> Iterator[None]:
    """Within the block, search these directories before those of ``MORSE_RESOURCE_PATH`` (``<project>/data``)."""
    before = list(_project_dirs)
    set_project_dirs(directories)
    try:
        yield
    finally:
        set_project_dirs(before)


def component_dirs() -> list[Path]:
    """Return the directories with one subdirectory per category.

    These are the directory of MORSE, those of packages in the entry points ``morse.assets``, and
    ``$MORSE_ROOT/share/morse/data``.
    """
    directories = [Path(MORSE_COMPONENTS)]
    for point in entry_points("morse.assets"):
        directories += _package_dirs(point.value)
    if root := variables.text("MORSE_ROOT"):
        directories.append(Path(root) / "share" / "morse" / "data")
    return directories


@lru_cache(maxsize=64)
def _package_dirs(package: str) -> list[Path]:
    """The directories of an installed package; an empty list, with a warning, if the package cannot be found."""
    error: object = "the package does not exist"
    try:
        spec = attempt(lambda: importlib.util.find_spec(package))  # importing a parent package runs third-party code
        if spec is not None and spec.submodule_search_locations:
            return [Path(directory) for directory in spec.submodule_search_locations]
    except PluginError as raised:
        error = raised
    logger.warning("the models of the installed package '%s' are left out: %s", package, error, extra=OF_MACHINE)
    return []


def worlds_with(name: object) -> str:
    """``; it is in the world a`` for the name of an object that worlds of MORSE have; else empty."""
    worlds = _worlds_of_objects().get(str(name), ())
    return f"; it is in the world{'s' if len(worlds) > 1 else ''} {', '.join(worlds)}" if worlds else ""


@lru_cache(maxsize=1)
def _worlds_of_objects() -> dict[str, list[str]]:
    """The names of objects, and the worlds of MORSE that have them; only the names in the files are read."""
    worlds: dict[str, list[str]] = {}
    folder = Path(MORSE_COMPONENTS, "environments")
    for path in sorted(path for path in folder.rglob("*") if is_model(path)):
        names = model_format(path).object_names
        world = path.relative_to(folder).with_suffix("").as_posix()
        for name in names(path) if names is not None else ():
            worlds.setdefault(name, []).append(world)
    return worlds


def resource_dirs() -> list[Path]:
    """Return the directories of projects: those of the running scene, then ``MORSE_RESOURCE_PATH``."""
    return [*_project_dirs, *map(Path, variables.paths("MORSE_RESOURCE_PATH"))]


def find(name: str, category: str = "") -> Path:
    """The file of a model.

    A name with the suffix of a model file is a path: absolute, below the current directory, below
    a resource directory or below a component directory. Any other name is looked for as
    ``<component directory>/<category>/<name>`` with such a suffix, then in the resource directories, then as a folder
    with ``model.config``, the form of models of Gazebo.

    Raises:
        AssetNotFoundError: the file does not exist.
        ValueError: the name cannot be the name of a file.
    """
    if "\0" in name or not name.strip():
        raise ValueError(f"{name!r} is not the name of a model file")
    for candidate in _candidates(name, category):
        # unlike Path.is_file, this treats a name that is too long for the file system as missing
        if os.path.isfile(candidate):
            return candidate.absolute()
    for folder in _folders(name):
        if os.path.isdir(folder):
            from morse.assets.gazebo.values import model_file

            file = model_file(folder)
            if file is not None:
                return file.absolute()
    raise AssetNotFoundError(_not_found(name, category))


def find_file(name: str, *folders: Path) -> Path:
    """A file that is not a model, such as a sound: in the current directory, or where the models of the project are.

    Args:
        name: a path.
        folders: searched before the directories of models.

    Raises:
        AssetNotFoundError: the file does not exist.
        ValueError: the name cannot be the name of a file.
    """
    if "\0" in name or not name.strip():
        raise ValueError(f"{name!r} is not the name of a file")
    path, directories = expanded(name), [*folders, *resource_dirs(), *component_dirs()]
    for candidate in (path, *(directory / path for directory in directories)):
        if os.path.isfile(candidate):
            return candidate.absolute()
    beside = {other.name for one in directories for other in _siblings(one / path)}
    near = difflib.get_close_matches(path.name, beside, n=1)
    hint = f"; did you mean '{path.parent / near[0]}'?" if near else ""
    places = ", ".join(map(str, dict.fromkeys([Path.cwd(), *directories])))
    raise AssetNotFoundError(f"there is no file {name[:200]!r}{hint} (searched: {places})")


def _siblings(path: Path) -> Iterator[Path]:
    try:
        yield from itertools.islice(path.parent.iterdir(), _MAX_ENTRIES)
    except OSError:
        return


def _candidates(name: str, category: str) -> Iterator[Path]:
    has_suffix = Path(name).suffix.lower() in suffixes()
    if has_suffix:
        yield expanded(name)
        names = [name]
    else:
        names = [name + suffix for suffix in suffixes()]
        yield from (directory / category / full for directory in component_dirs() for full in names)
    for directory in resource_dirs():
        yield from (directory / full for full in names)
        if category:
            yield from (directory / category / full for full in names)
    if has_suffix:
        yield from (directory / part / name for directory in component_dirs() for part in {"", category})


def _folders(name: str) -> Iterator[Path]:
    """The folders that may be a model of Gazebo."""
    plain = name.removeprefix("model://")
    yield expanded(plain)
    folders = [Path(entry) for variable in MODEL_PATHS for entry in variables.paths(variable)]
    yield from (directory / plain for directory in [*resource_dirs(), *folders])


def _not_found(name: str, category: str) -> str:
    candidates = available(category)
    close = difflib.get_close_matches(name, candidates, n=3, cutoff=0.5) or difflib.get_close_matches(
        name.rsplit("/", 1)[-1], candidates, n=3
    )
    kind = f" in '{category}'" if category else ""
    message = f"no model '{name if len(name) <= 80 else name[:77] + '...'}'{kind}"
    if close:
        message += f"; did you mean {' or '.join(repr(c) for c in close)}?"
    elif (suffix := Path(name).suffix.lower()) and suffix not in suffixes():
        message += f"; the suffix '{suffix[:20]}' is none of a model: {', '.join(suffixes())}"
    elif candidates:
        message += f"; there are: {', '.join(candidates[:12])}{', ...' if len(candidates) > 12 else ''}"
    places = ", ".join(str(directory) for directory in [*component_dirs(), *resource_dirs()])
    return f"{message} (searched: {places}; more directories: MORSE_RESOURCE_PATH)"


def available(category: str = "") -> list[str]:
    """Return the names that `find` accepts for a category, sorted, without suffix, relative to the category."""
    names: set[str] = set()
    for directory in component_dirs():
        names.update(_models_below(directory / category, keep_suffix=False))
    for directory in resource_dirs():
        names.update(_models_below(directory, keep_suffix=True))
    return sorted(names)


def _models_below(directory: Path, *, keep_suffix: bool) -> Iterator[str]:
    if directory.is_dir():
        readable = suffixes()
        # the search is limited, because a search path may contain a large tree such as a home directory
        for path in itertools.islice(directory.rglob("*"), _MAX_ENTRIES):
            if path.suffix.lower() in readable and not path.name.startswith((".", "@")):
                relative = path.relative_to(directory)
                yield (relative if keep_suffix else relative.with_suffix("")).as_posix()
