"""Meshes that a URDF file names."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

from morse.assets.formats import SUFFIXES, reader_of
from morse.assets.loader import instantiate

if TYPE_CHECKING:
    from morse.scene import Library, Node


#: metres
_FARTHEST = 1e6


class MeshError(ValueError):
    """A mesh cannot be used; the message says why."""


def find_mesh(name: str, urdf: Path) -> Path:
    """The file of a mesh: ``package://robot/meshes/arm.stl``, ``file:///...``, or a path beside the URDF file.

    A package is a folder above the file, or one that ROS_PACKAGE_PATH lists or holds.

    Raises:
        MeshError: there is no such file.
    """
    for candidate in _candidates(name, urdf):
        if os.path.isfile(candidate):
            return candidate
    hint = "; ROS_PACKAGE_PATH may list more folders" if name.startswith(("package://", "model://")) else ""
    raise MeshError(f"there is no file{hint}")


def _candidates(name: str, urdf: Path) -> list[Path]:
    if "\0" in name:
        return []
    scheme, separator, rest = name.partition("://")
    if not separator:
        return [urdf.parent / name]
    if scheme == "file":
        return [Path(rest), urdf.parent / rest]
    package, _, inside = rest.partition("/")
    found = []
    for folder in urdf.absolute().parents:
        found += [folder / package / inside] + ([folder / inside] if folder.name == package else [])
    for entry in filter(None, os.environ.get("ROS_PACKAGE_PATH", "").split(os.pathsep)):
        folder = Path(entry)
        found += [folder / package / inside] + ([folder / inside] if folder.name == package else [])
    return found


def mesh_nodes(path: Path, *, known: dict[Path, Library]) -> list[Node]:
    """Copies of the nodes of a mesh file.

    Args:
        known: the files that have been read already; others are added.

    Raises:
        AssetError: the file is damaged.
        MeshError: files of that type cannot be read, or it is too large.
    """
    suffix = path.suffix.lower()
    if suffix not in SUFFIXES or suffix in (".blend", ".urdf"):
        kinds = ", ".join(sorted(set(SUFFIXES) - {".blend", ".urdf"}))
        raise MeshError(f"files of type '{path.suffix}' cannot be read; supported: {kinds}")
    if path not in known:
        library = reader_of(path)(path)
        for mesh in (node.mesh for node in library.nodes() if node.mesh is not None):
            if mesh.vertices.size and not abs(mesh.vertices).max() < _FARTHEST:
                raise MeshError(f"vertices of '{mesh.name}' are farther away than {_FARTHEST:g} m")
        known[path] = library
    return [instantiate(root) for root in known[path].roots]
