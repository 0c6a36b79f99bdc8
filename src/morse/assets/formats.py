"""The kinds of model files that can be read."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, cast

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
    ".stl": "morse.assets.meshfiles:read_meshes",
    ".urdf": "morse.assets.urdf:read_urdf",
    ".xml": "morse.assets.mjcf:read_mjcf",
}

#: the suffixes, the preferred one first
SUFFIXES = tuple(_READERS)
#: suffixes of files that contain only meshes
MESH_SUFFIXES = tuple(suffix for suffix, reader in _READERS.items() if reader.startswith("morse.assets.meshfiles"))


class UnsupportedFormatError(ValueError):
    """There is no reader for this kind of file."""


def reader_of(path: Path) -> Callable[[Path], Library]:
    """The function that reads a file.

    Raises:
        UnsupportedFormatError: there is no reader for its suffix.
    """
    entry = _READERS.get(path.suffix.lower())
    if entry is None:
        raise UnsupportedFormatError(
            f"'{path}': cannot read files of type '{path.suffix or 'without suffix'}'; "
            f"supported: {', '.join(SUFFIXES)}. Open it in Blender and save it as .blend"
        )
    module, function = entry.split(":")
    return cast("Callable[[Path], Library]", getattr(import_module(module), function))
