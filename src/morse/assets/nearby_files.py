"""The files that a model of a robot may refer to: those of its package, and of folders that the user lists."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

from morse.assets import search

if TYPE_CHECKING:
    from collections.abc import Iterator

#: files that mark the folder of a package
_MARKS = ("package.xml", "model.config", "manifest.xml")
#: maximum number of folders above a model that are searched for its package
_LEVELS = 4


class FileRefusedError(ValueError):
    """A file is missing or must not be read; the message contains the reason."""


def find_near(name: str, model: Path) -> Path:
    """Return the file that a model refers to: ``package://robot/meshes/arm.stl``, ``file:///...`` or a path.

    A package is a folder above the model, a folder beside one of these folders, or a folder in ROS_PACKAGE_PATH or
    directly below one of them. After symbolic links are resolved, a file must be in the package of the model, or in a
    folder of ROS_PACKAGE_PATH, MORSE_RESOURCE_PATH or of the project. If no file marks the package of the model, the
    folder of the model and its parent are used.

    Raises:
        FileRefusedError: the file does not exist, or is in another folder.
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
            f"it is at {elsewhere}, outside of the package of the model; "
            "to allow it, add the folder to MORSE_RESOURCE_PATH"
        )
    hint = "; add more folders with ROS_PACKAGE_PATH" if is_package else ""
    raise FileRefusedError(f"the file does not exist{hint}")


def _folders(model: Path) -> Iterator[Path]:
    """The folders whose files may all be read."""
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
    """Yield possible paths of the file, each with a folder that may contain it in addition to the usual folders."""
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
