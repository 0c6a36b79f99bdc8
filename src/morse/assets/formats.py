"""The kinds of model files that can be read."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, cast

from morse.core.classes.plugins import entry_points

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from morse.scene import Library

#: suffix to the function that reads such files; it is imported when the first one is read
_READERS = {
    ".blend": "morse.assets.blend:read_blend",
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
    """The suffixes of the files that can be read, the preferred one first.

    Those of installed packages, which the entry points ``morse.formats`` name without a dot, come last.
    """
    return tuple(dict.fromkeys((*_READERS, *(f".{point.name.lower()}" for point in entry_points("morse.formats")))))


def is_model(path: Path) -> bool:
    """Whether a file is a model by its suffix; any other one that is run as a scene is a program."""
    return path.suffix.lower() in suffixes()


def reader_of(path: Path) -> Callable[[Path], Library]:
    """The function that reads a file.

    Raises:
        UnsupportedFormatError: there is no reader for its suffix, or the package that brings the reader is broken.
    """
    entry = _READERS.get(path.suffix.lower())
    if entry is None:
        return _installed_reader(path)
    module, function = entry.split(":")
    return cast("Callable[[Path], Library]", getattr(import_module(module), function))


def _installed_reader(path: Path) -> Callable[[Path], Library]:
    for point in entry_points("morse.formats"):
        if f".{point.name.lower()}" == path.suffix.lower():
            try:
                return cast("Callable[[Path], Library]", point.load())
            except Exception as error:  # the package is third-party code
                raise UnsupportedFormatError(
                    f"'{path}': the reader of an installed package ({point.value}) cannot be loaded: "
                    f"{type(error).__name__}: {error}"
                ) from None
    raise UnsupportedFormatError(
        f"'{path}': cannot read files of type '{path.suffix or 'without suffix'}'; "
        f"supported: {', '.join(suffixes())}. Open it in Blender and save it as .blend"
    )
