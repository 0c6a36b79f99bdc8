"""Meshes that model files of robots refer to."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.assets.formats import MESH_SUFFIXES, reader_of
from morse.assets.loader import instantiate
from morse.assets.meshfiles.reader import GLTF_SUFFIXES, read_meshes

if TYPE_CHECKING:
    from pathlib import Path

    from morse.scene import Library, Node

#: largest accepted coordinate, metres
_FARTHEST = 1e6


class MeshError(ValueError):
    """A mesh cannot be used; the message contains the reason."""


def mesh_nodes(path: Path, *, libraries: dict[Path, Library], keeps_axes: bool = False) -> list[Node]:
    """Copies of the nodes of a mesh file.

    Args:
        libraries: the files that have already been read; newly read files are added.
        keeps_axes: whether the axes of glTF are kept.

    Raises:
        AssetError: the file is damaged.
        MeshError: files of that type cannot be read, or it is too large.
    """
    if path.suffix.lower() not in MESH_SUFFIXES:
        kinds = ", ".join(MESH_SUFFIXES)
        raise MeshError(f"files of type '{path.suffix}' cannot be read; supported: {kinds}")
    if path not in libraries:
        is_gltf = path.suffix.lower() in GLTF_SUFFIXES
        library = read_meshes(path, keeps_axes=True) if keeps_axes and is_gltf else reader_of(path)(path)
        for mesh in (node.mesh for node in library.nodes() if node.mesh is not None):
            if mesh.vertices.size and not abs(mesh.vertices).max() < _FARTHEST:
                raise MeshError(f"vertices of '{mesh.name}' are farther from the origin than {_FARTHEST:g} m")
        libraries[path] = library
    return [instantiate(root) for root in libraries[path].roots]
