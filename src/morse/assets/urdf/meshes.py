"""Meshes that a URDF file names."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from morse.scene import Mesh

if TYPE_CHECKING:
    from morse.scene import Material

_MOST_BYTES = 256 << 20
_MOST_TRIANGLES = 2_000_000
_SUFFIXES = (".stl", ".obj", ".ply", ".off", ".glb", ".gltf", ".dae", ".3mf")


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


def read_mesh(path: Path) -> Mesh:
    """Read STL, OBJ, PLY, OFF, glTF or 3MF, and COLLADA where pycollada is installed, by trimesh.

    Raises:
        MeshError: it cannot be read.
    """
    if path.suffix.lower() not in _SUFFIXES:
        raise MeshError(f"files of the type '{path.suffix}' are not read; those of {', '.join(_SUFFIXES)} are")
    try:
        import trimesh
    except ImportError:
        raise MeshError("meshes are read by trimesh: pip install 'morse-simulator[urdf]'") from None
    if path.stat().st_size > _MOST_BYTES:
        raise MeshError(f"it is larger than {_MOST_BYTES >> 20} MB")
    try:
        read: Any = trimesh.load(path, force="mesh", process=False)
        vertices, triangles = np.asarray(read.vertices), np.asarray(read.faces)
    except Exception as error:  # a third-party reader on a file of anybody
        raise MeshError(f"trimesh cannot read it: {type(error).__name__}: {error}") from None
    if triangles.ndim != 2 or not 0 < len(triangles) <= _MOST_TRIANGLES:
        raise MeshError(f"it has {len(triangles)} triangles, expected 1 to {_MOST_TRIANGLES}")
    if not np.isfinite(vertices).all() or np.abs(vertices).max() > 1e6:
        raise MeshError("it has vertices that are not finite or too far away")
    if triangles.min() < 0 or triangles.max() >= len(vertices):
        raise MeshError("it has triangles without vertices")
    return Mesh(
        path.stem,
        np.ascontiguousarray(vertices, dtype=np.float32),
        np.ascontiguousarray(triangles, dtype=np.int32),
        np.zeros(len(triangles), dtype=np.int32),
    )


def painted(mesh: Mesh, material: Material) -> Mesh:
    """The same mesh with a material."""
    return Mesh(mesh.name, mesh.vertices, mesh.triangles, mesh.material_index, mesh.uvs, mesh.normals, (material,))
