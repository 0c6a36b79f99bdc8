"""The files that a model of a robot may name: those of its package, and of folders that the user lists."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

from morse.assets import search

if TYPE_CHECKING:
    from collections.abc import Iterator

#: files that only the folder of a package has
_MARKS = ("package.xml", "model.config", "manifest.xml")
#: folders above a model that may be its package
_LEVELS = 4


class FileRefusedError(ValueError):
    """A file is missing or must not be read; the message says why."""


def find_near(name: str, model: Path) -> Path:
    """Return the file that a model names: ``package://robot/meshes/arm.stl``, ``file:///...`` or a path.

    A package is a folder above the model, a folder beside one of them, or one that ROS_PACKAGE_PATH lists or holds. A
    file
    is read only if it is, links resolved, in the package of the model (the folder of the model and the folder above
    it, if
    no package says how far it reaches), or in a folder of ROS_PACKAGE_PATH, MORSE_RESOURCE_PATH or of the project.

    Raises:
        FileRefusedError: there is no such file, or it is elsewhere.
    """
    is_package = name.startswith(("package://", "model://"))
    elsewhere = None
    for candidate, own in _candidates(name, model):
        if not os.path.isfile(candidate):
            continue
        real = Path(os.path.realpath(candidate))
        if any(real.is_relative_to(os.path.realpath(folder)) for folder in (*own, *_folders(model))):
            return candidate
        elsewhere = elsewhere or real
    if elsewhere is not None:
        raise FileRefusedError(
            f"it is at {elsewhere}, outside of the package of the model; MORSE_RESOURCE_PATH may list the folder"
        )
    hint = "; ROS_PACKAGE_PATH may list more folders" if is_package else ""
    raise FileRefusedError(f"there is no file{hint}")


def _folders(model: Path) -> Iterator[Path]:
    """The folders of which all files may be read."""
    folder = model.absolute().parent
    yield folder
    above = [one for one in (folder, *folder.parents) if any((one / mark).is_file() for mark in _MARKS)]
    if above:
        yield above[0]
    elif folder.parent != Path(folder.anchor):
        yield folder.parent
    yield from search.resource_dirs()
    yield from search.component_dirs()
    yield from _listed()


def _listed() -> list[Path]:
    return [Path(entry) for entry in os.environ.get("ROS_PACKAGE_PATH", "").split(os.pathsep) if entry]


def _candidates(name: str, model: Path) -> Iterator[tuple[Path, tuple[Path, ...]]]:
    """Yield paths, each with a folder of which it may be besides the usual ones."""
    if "\0" in name:
        return
    scheme, separator, rest = name.partition("://")
    if not separator:
        yield model.parent / name.replace("\\", "/"), ()
        return
    if scheme == "file":
        yield Path(rest), ()
        yield model.parent / rest.lstrip("/"), ()
        return
    package, _, inside = rest.partition("/")
    if not package or package in (".", ".."):
        return
    for folder in list(model.absolute().parents)[:_LEVELS]:
        if folder.name == package:
            yield folder / inside, (folder,)
        if folder != Path(folder.anchor):
            yield folder / package / inside, (folder / package,)
    for folder in _listed():
        yield folder / package / inside, ()
        if folder.name == package:
            yield folder / inside, ()
