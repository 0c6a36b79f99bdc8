"""Refuses mesh files with counts that would take excessive time or memory, before they are read."""

from __future__ import annotations

import json
import re
import struct
from typing import TYPE_CHECKING, Any

from morse.assets.errors import AssetError

if TYPE_CHECKING:
    from pathlib import Path

#: maximum number of nodes, and of meshes with one material; a file with more takes minutes
_MOST_PARTS = 10_000
#: maximum number of nodes above a node
_DEEPEST = 500
#: maximum number of items of arrays of a glTF file that are not in the file: arrays of zeros, and arrays with few other
#: values
_MOST_IMPLIED = 10_000_000
_GLB = struct.Struct("<4sIIII")
#: lines of OBJ files that begin an object, a group or a material
_OBJ_PARTS = re.compile(rb"^[ \t]*(?:o|g|usemtl)[ \t]", re.MULTILINE)


def check_counts(path: Path) -> None:
    """Check the counts of a glTF or OBJ file.

    Raises:
        AssetError: there are too many parts, or an array is too large.
    """
    suffix = path.suffix.lower()
    if suffix == ".obj":
        _refuse_many(path, sum(1 for _ in _OBJ_PARTS.finditer(path.read_bytes())), "objects, groups and materials")
    elif suffix in (".gltf", ".glb") and isinstance(tree := _tree(path, suffix), dict):
        _check_gltf(path, tree)


def _tree(path: Path, suffix: str) -> Any:
    """The JSON part of a glTF file; None if it is broken, which its reader reports."""
    try:
        if suffix == ".gltf":
            return json.loads(path.read_bytes())
        with path.open("rb") as file:
            _, _, _, size, _ = _GLB.unpack(file.read(_GLB.size))
            return json.loads(file.read(size))
    except (ValueError, struct.error, RecursionError):
        return None


def _check_gltf(path: Path, tree: dict[str, Any]) -> None:
    nodes = _objects(tree, "nodes")
    _refuse_many(path, len(nodes), "nodes")
    uses = [node.get("mesh") for node in nodes]
    primitives = [len(_objects(mesh, "primitives")) for mesh in _objects(tree, "meshes")]
    _refuse_many(path, sum(primitives), "meshes")
    shown = sum(primitives[use] for use in uses if isinstance(use, int) and 0 <= use < len(primitives))
    _refuse_many(path, shown, "meshes that its nodes show")
    _refuse_deep(path, nodes)
    implied = sum(_count(accessor) for accessor in _objects(tree, "accessors") if _is_implied(accessor))
    if implied > _MOST_IMPLIED:
        raise AssetError(path, f"it has arrays of {implied} items that are not in the file")


def _objects(table: dict[str, Any], name: str) -> list[dict[str, Any]]:
    given = table.get(name)
    return [one for one in given if isinstance(one, dict)] if isinstance(given, list) else []


def _is_implied(accessor: dict[str, Any]) -> bool:
    return "bufferView" not in accessor or "sparse" in accessor


def _count(accessor: dict[str, Any]) -> int:
    count = accessor.get("count")
    return count if isinstance(count, int) and count > 0 else 0


def _refuse_many(path: Path, count: int, what: str) -> None:
    if count > _MOST_PARTS:
        raise AssetError(path, f"it has {count} {what}, at most {_MOST_PARTS} can be read: join some of them")


def _refuse_deep(path: Path, nodes: list[dict[str, Any]]) -> None:
    above: dict[int, int] = {}
    for number, node in enumerate(nodes):
        children = node.get("children")
        for child in children if isinstance(children, list) else ():
            if isinstance(child, int):
                above.setdefault(child, number)
    depth: dict[int, int] = {}
    for start in above:
        chain: list[int] = []
        number = start
        while number in above and number not in depth and len(chain) <= _DEEPEST:
            chain.append(number)
            number = above[number]
        for below, one in enumerate(reversed(chain), 1):
            depth[one] = depth.get(number, 0) + below
            if depth[one] > _DEEPEST:
                raise AssetError(path, f"its nodes are nested more than {_DEEPEST} deep, or are parts of themselves")
