"""The kinds of model files that can be read.

A package brings a reader by an entry point, whose name is the suffix of the files; it names the function, or a
`ModelFormat`::

    [project.entry-points."morse.formats"]
    boxes = "my_lab.boxes:read_boxes"
"""

from __future__ import annotations

import logging
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from functools import lru_cache
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, cast

from morse.core.classes.plugins import PluginError, entry_points, load
from morse.system import OF_MACHINE

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator
    from importlib.metadata import EntryPoint

    from morse.scene import Library

logger = logging.getLogger(__name__)


#: arguments of the model file that is being read
ARGUMENTS: ContextVar[dict[str, str]] = ContextVar("arguments")
#: whether model files may contain substitutions, such as ``$(find PACKAGE)``
SUBSTITUTIONS: ContextVar[bool] = ContextVar("substitutions", default=True)


@contextmanager
def of_strangers() -> Iterator[None]:
    """Model files that are read here were sent by somebody: substitutions in them are refused."""
    token = SUBSTITUTIONS.set(False)
    try:
        yield
    finally:
        SUBSTITUTIONS.reset(token)


@dataclass(frozen=True, slots=True)
class ModelFormat:
    """A kind of model files.

    Attributes:
        read: the function that reads a file.
        object_names: a function that finds the names of the objects of a file faster, for error messages; or None.
        purpose: what such files are, in a few words, for lists of what is installed.
    """

    read: Callable[[Path], Library]
    object_names: Callable[[Path], Iterable[str]] | None = None
    purpose: str = ""


#: suffix to the function that reads such files; it is imported when the first one is read
_READERS = {
    ".dae": "morse.assets.meshfiles:read_meshes",
    ".glb": "morse.assets.meshfiles:read_meshes",
    ".gltf": "morse.assets.meshfiles:read_meshes",
    ".mjcf": "morse.assets.mjcf:read_mjcf",
    ".obj": "morse.assets.meshfiles:read_meshes",
    ".ply": "morse.assets.meshfiles:read_meshes",
    ".sdf": "morse.assets.sdf:read_sdf",
    ".stl": "morse.assets.meshfiles:read_meshes",
    ".urdf": "morse.assets.urdf:read_urdf",
    ".xacro": "morse.assets.urdf:read_urdf",
    ".world": "morse.assets.sdf:read_sdf",
    ".xml": "morse.assets.mjcf:read_mjcf",
}

#: suffixes of files that contain only meshes
MESH_SUFFIXES = tuple(suffix for suffix, reader in _READERS.items() if reader.startswith("morse.assets.meshfiles"))


class UnsupportedFormatError(ValueError):
    """There is no reader for this kind of file, or the package that brings the reader is broken."""


def suffixes() -> tuple[str, ...]:
    """The suffixes of the files that can be read, the preferred one first: those of packages and plug-ins."""
    return (*_of_packages(entry_points("morse.formats"))[0], *_READERS)


@lru_cache(maxsize=8)
def _of_packages(points: tuple[EntryPoint, ...]) -> tuple[dict[str, EntryPoint], dict[EntryPoint, str]]:
    """The entry points by suffix; and those that are left out, with the reason."""
    found: dict[str, EntryPoint] = {}
    left_out: dict[EntryPoint, str] = {}
    for point in points:
        suffix = f".{point.name.lower()}"
        if suffix in found:
            left_out[point] = f"files {suffix} have {found[suffix].value}"
        elif suffix == ".py" or suffix in _READERS:
            left_out[point] = f"files {suffix} are MORSE's"
        elif Path(f"model{suffix}").suffix != suffix:
            near = point.name.strip(".").rpartition(".")[2]
            left_out[point] = f"'{point.name}' is not a suffix of files; write it without a point, such as '{near}'"
        else:
            found[suffix] = point
    for point, reason in left_out.items():
        logger.warning("the reader %s of a package is left out: %s", point.value, reason, extra=OF_MACHINE)
    return found, left_out


def why_left_out(point: EntryPoint) -> str:
    """Why files are not read by the reader that an entry point names; empty if they are."""
    return _of_packages(entry_points("morse.formats"))[1].get(point, "")


def is_model(path: Path) -> bool:
    """Whether a file is a model by its suffix; any other one that is run as a scene is a program."""
    return path.suffix.lower() in suffixes()


def reader_of(path: Path) -> Callable[[Path], Library]:
    """The function that reads a file.

    Raises:
        UnsupportedFormatError: there is no reader for its suffix, or the package that brings the reader is broken.
    """
    return model_format(path).read


def model_format(path: Path) -> ModelFormat:
    """The format of a file.

    Raises:
        UnsupportedFormatError: there is no reader for its suffix, or the package that brings the reader is broken.
    """
    suffix = path.suffix.lower()
    if (entry := _READERS.get(suffix)) is not None:
        module, function = entry.split(":")
        return ModelFormat(cast("Callable[[Path], Library]", getattr(import_module(module), function)))
    if (point := _of_packages(entry_points("morse.formats"))[0].get(suffix)) is not None:
        try:
            return load(point, as_format)
        except PluginError as error:
            raise UnsupportedFormatError(
                f"'{path}': the reader of an installed package ({point.value}) cannot be loaded: {error}"
            ) from None
    raise UnsupportedFormatError(
        f"'{path}': cannot read files of type '{path.suffix or 'without suffix'}'; "
        f"supported: {', '.join(suffixes())}. Convert it with the program that has written it, "
        "or add a reader by the entry point morse.formats"
    )


def as_format(found: object) -> ModelFormat:
    """What an entry point names, as a description.

    Raises:
        TypeError: it is neither a description nor a function.
    """
    if isinstance(found, ModelFormat):
        return found
    if not callable(found):
        raise TypeError(f"it is {found!r:.80}, expected a function or a ModelFormat")
    return ModelFormat(found)
