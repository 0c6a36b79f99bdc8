"""Loads model files as libraries of nodes, with a cache, and copies their nodes."""

from __future__ import annotations

import logging
import os
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from morse.assets.formats import ARGUMENTS, reader_of
from morse.assets.triangle_limit import check_triangles
from morse.scene.scene_warnings import is_first
from morse.system.regular_files import budget_of_file, open_regular

if TYPE_CHECKING:
    from collections.abc import Mapping

    from morse.scene import Library, Node

logger = logging.getLogger(__name__)

#: warnings of a file that are logged
_MOST_WARNINGS = 100
#: from a path and arguments to (modification time, size) of the file and its content
_cache: dict[tuple[Path, tuple[tuple[str, str], ...]], tuple[tuple[int, int], Library]] = {}


def load(path: str | Path, arguments: Mapping[str, str] | None = None) -> Library:
    """Read a model file, or return the cached content if the file has not changed.

    Args:
        path: the file.
        arguments: of a file of xacro.

    The library is shared: take copies of its nodes (`instantiate`).

    Raises:
        OSError: the file is missing, cannot be read, or is a pipe or a device.
        UnsupportedFormatError: there is no reader for this kind of file.
        ValueError: the file is damaged, or has too many triangles (the readers have their own subclasses).
    """
    path = Path(path).absolute()
    reader = reader_of(path)
    with open_regular(path) as file:
        status = os.fstat(file.fileno())
    stamp = (status.st_mtime_ns, status.st_size)
    key = path, tuple(sorted((arguments or {}).items()))
    present = _cache.get(key)
    if present is not None and present[0] == stamp:
        _warn(path, present[1])
        return present[1]
    token = ARGUMENTS.set(dict(arguments or {}))
    try:
        with budget_of_file():
            library = reader(path)
    finally:
        ARGUMENTS.reset(token)
    meshes = {id(node.mesh): node.mesh for root in library.roots for node in root.walk() if node.mesh is not None}
    check_triangles(path, (len(mesh.triangles) for mesh in meshes.values()))
    _cache[key] = (stamp, library)
    _warn(path, library, read=True)
    return library


def _warn(path: Path, library: Library, *, read: bool = False) -> None:
    """Log the warnings of a file, once for each scene; outside of a scene, when it is read."""
    if library.warnings and is_first(path, otherwise=read):
        for warning in library.warnings[:_MOST_WARNINGS]:
            logger.warning("%s: %s", path.name, warning)
        if len(library.warnings) > _MOST_WARNINGS:
            logger.warning("%s: %d more warnings of this file", path.name, len(library.warnings) - _MOST_WARNINGS)


def instantiate(node: Node) -> Node:
    """Return a copy of a node and all nodes below it, without a parent.

    Poses, properties and settings are copied; meshes, materials and images are shared.
    """
    copies: dict[Node, Node] = {}
    for original in node.walk():
        copy = copies[original] = _copy(original)
        if original is not node and original.parent is not None:
            copy.parent = copies[original.parent]
            copy.parent.children.append(copy)
    return copies[node]


def _copy(node: Node) -> Node:
    return replace(
        node,
        location=list(node.location),
        rotation_euler=list(node.rotation_euler),
        scale=list(node.scale),
        parent=None,
        children=[],
        parent_inverse=None if node.parent_inverse is None else node.parent_inverse.copy(),
        materials=list(node.materials),
        light=None if node.light is None else replace(node.light),
        camera=None if node.camera is None else replace(node.camera),
        body=replace(node.body),
        properties=dict(node.properties),
        source_name=node.source_name or node.name,
        shapes=None if node.shapes is None else list(node.shapes),
    )
