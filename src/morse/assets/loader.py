"""Loads model files as libraries of nodes, with a cache, and copies their nodes."""

from __future__ import annotations

import logging
import math
import os
import reprlib
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from morse.assets.errors import AssetError
from morse.assets.formats import ARGUMENTS, reader_of
from morse.assets.triangle_limit import MOST_MATERIALS, check_triangles
from morse.scene import Library, Node
from morse.scene.scene_warnings import is_first
from morse.system.regular_files import budget_of_file, open_regular

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from morse.scene import Mesh

logger = logging.getLogger(__name__)

#: warnings of a file that are logged
_MOST_WARNINGS = 100
#: nodes below each other
_DEEPEST = 300
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
        ValueError: the file is damaged, has too many triangles, or its reader returns nodes that are wrong (the readers
            have their own subclasses).
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
    meshes = _check(path, library)
    check_triangles(path, (len(mesh.triangles) for mesh in meshes))
    _cache[key] = (stamp, library)
    _warn(path, library, read=True)
    return library


class Content(NamedTuple):
    """The content of a file, to be sent to another process.

    Attributes:
        path: of the file.
        stamp: modification time, ns, and size, bytes, when it was read.
        library: its nodes.
    """

    path: Path
    stamp: tuple[int, int]
    library: Library


def content_of(path: Path) -> Content:
    """The content of a file that was read by `load`, without arguments."""
    return Content(path.absolute(), *_cache[path.absolute(), ()])


def keep(contents: Iterable[Content]) -> None:
    """Take contents of files that another process has read: `load` does not read them again."""
    for one in contents:
        _cache[one.path, ()] = (one.stamp, one.library)


def _check(path: Path, library: Library) -> list[Mesh]:
    """Refuse what a reader has returned if it is not what `morse.scene` describes.

    Engine, rays and images index arrays by it without further checks.

    Returns:
        The meshes of the file, each once.

    Raises:
        AssetError: a node is wrong; the message names it.
    """
    if not isinstance(library, Library) or not isinstance(library.roots, list):
        raise AssetError(path, f"its reader has returned {reprlib.repr(library)}, expected a morse.scene.Library")
    meshes: dict[int, Mesh] = {}
    found: set[int] = set()
    waiting: list[tuple[Node, Node | None, int]] = [(root, None, 0) for root in library.roots]
    while waiting:
        node, parent, depth = waiting.pop()
        if not isinstance(node, Node) or not isinstance(node.name, str):
            raise AssetError(
                path, f"its reader has returned {reprlib.repr(node)} as a node, expected a Node with a name"
            )
        if depth > _DEEPEST:
            raise AssetError(path, f"its nodes are more than {_DEEPEST} deep, at '{node.name:.60}'")
        if id(node) in found or node.parent is not parent:
            where = "twice in the tree" if id(node) in found else "not below its 'parent'"
            raise AssetError(path, f"the node '{node.name:.60}' is {where}")
        found.add(id(node))
        for fault in _faults(node):
            raise AssetError(path, f"the node '{node.name:.60}': {fault}")
        if node.mesh is not None and id(node.mesh) not in meshes:
            meshes[id(node.mesh)] = node.mesh
            for fault in _faults_of_mesh(node.mesh):
                raise AssetError(path, f"the node '{node.name:.60}': {fault} of its mesh")
        waiting.extend((child, node, depth + 1) for child in node.children)
    return list(meshes.values())


def _faults(node: Node) -> Iterator[str]:
    for name in ("location", "rotation_euler", "scale"):
        if not _are_numbers(getattr(node, name), 3):
            yield f"{name}={reprlib.repr(getattr(node, name))}, expected three finite numbers"
    masses = [node.body.mass, *([] if node.inertial is None else [node.inertial.mass])]
    for mass in masses:
        if not _are_numbers((mass,), 1) or mass < 0.0:
            yield f"its mass is {reprlib.repr(mass)}, expected a number of kg"
    if node.inertial is not None:
        for name, count in (("centre", 3), ("inertia", 9)):
            if not _are_numbers(getattr(node.inertial, name), count):
                given = reprlib.repr(getattr(node.inertial, name))
                yield f"the {name} of its mass is {given}, expected {count} finite numbers"
    for index, bone in enumerate(node.bones):
        if not -1 <= bone.parent < index:
            yield f"the bone '{bone.name:.60}' has the parent {bone.parent}, expected -1 or the index of one before it"
        if not (-1 <= bone.leader < len(node.bones) and bone.leader != index):
            yield f"the bone '{bone.name:.60}' has the leader {bone.leader}, expected -1 or the index of another bone"
        if bone.axis not in (0, 1, 2):
            yield f"the bone '{bone.name:.60}' has the axis {bone.axis}, expected 0, 1 or 2"
        if not _are_numbers(bone.position, 3) or not _are_numbers(bone.rotation, 9):
            yield f"the frame of the bone '{bone.name:.60}' is not 3 and 9 finite numbers"
        if not bone.low <= bone.high:
            yield f"the bone '{bone.name:.60}' has the limits {bone.low} and {bone.high}, expected low <= high"


def _faults_of_mesh(mesh: Mesh) -> Iterator[str]:
    import numpy as np

    count = len(mesh.triangles)
    for name, kinds, shape in (
        ("vertices", "f", (len(mesh.vertices), 3)),
        ("triangles", "iu", (count, 3)),
        ("material_index", "iu", (count,)),
        ("uvs", "f", (count, 3, 2)),
        ("normals", "f", (count, 3, 3)),
    ):
        array = getattr(mesh, name)
        if array is None and name in ("uvs", "normals"):
            continue
        if not isinstance(array, np.ndarray) or array.dtype.kind not in kinds or array.shape != shape:
            has = f"{array.dtype} {array.shape}" if isinstance(array, np.ndarray) else reprlib.repr(array)
            yield f"{has} as {name}, expected an array of {'numbers' if kinds == 'f' else 'integers'} {shape},"
    if not np.isfinite(mesh.vertices).all():
        yield "a number that is not finite is among the vertices"
    for name, most in (("triangles", len(mesh.vertices)), ("material_index", MOST_MATERIALS)):
        indices = getattr(mesh, name)
        if indices.size and not 0 <= int(indices.min()) <= int(indices.max()) < most:
            yield f"the indices {indices.min()} to {indices.max()}, expected 0 to {most - 1}, are the {name}"


def _are_numbers(values: Iterable[object], count: int) -> bool:
    """Whether these are so many finite numbers."""
    try:
        numbers = [float(value) for value in values]  # type: ignore[arg-type]
    except (TypeError, ValueError, OverflowError):
        return False
    return len(numbers) == count and all(map(math.isfinite, numbers))


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
