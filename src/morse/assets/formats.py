"""The kinds of model files that can be read.

A package brings a reader by an entry point, whose name is the suffix of the files; it names the function, or a
`ModelFormat`::

    [project.entry-points."morse.formats"]
    boxes = "my_lab.boxes:read_boxes"
"""

from __future__ import annotations

from dataclasses import dataclass
from importlib import import_module
from typing import TYPE_CHECKING, cast

from morse.core.classes.plugins import entry_points

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable
    from pathlib import Path

    from morse.scene import Library


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
    return tuple(dict.fromkeys((*(f".{point.name.lower()}" for point in entry_points("morse.formats")), *_READERS)))


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
    for point in entry_points("morse.formats"):
        if f".{point.name.lower()}" == suffix:
            try:
                found = point.load()
            except Exception as error:  # the package is third-party code
                raise UnsupportedFormatError(
                    f"'{path}': the reader of an installed package ({point.value}) cannot be loaded: "
                    f"{type(error).__name__}: {error}"
                ) from None
            return found if isinstance(found, ModelFormat) else ModelFormat(found)
    raise UnsupportedFormatError(
        f"'{path}': cannot read files of type '{path.suffix or 'without suffix'}'; "
        f"supported: {', '.join(suffixes())}. Convert it with the program that has written it"
    )
