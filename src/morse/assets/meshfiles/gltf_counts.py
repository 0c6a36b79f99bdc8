"""Refuses glTF files that would take excessive time or memory, before they are read."""

from __future__ import annotations

import base64
import contextlib
import json
import struct
from typing import TYPE_CHECKING
from urllib.parse import unquote

from morse.assets.errors import AssetError
from morse.assets.pictures import chequered
from morse.assets.triangle_limit import check_parts, check_triangles
from morse.system.pictures import readable_picture

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from morse.assets.meshfiles.files import Below

#: maximum number of nodes above a node
_DEEPEST = 500
#: maximum number of items of arrays of a glTF file that are not in the file: arrays of zeros, arrays with few other
#: values, and arrays that are used again
_MOST_IMPLIED = 1_000_000
#: maximum size of all buffers together, and of all arrays relative to the buffers
_MOST_BYTES, _OVERLAP = 512 << 20, 4
#: pictures of this kind are not opened by trimesh
_NOT_OPENED = "image/ktx2"
#: the head of a binary file: its mark, version, size, and the size and the kind of its JSON part
_GLB, _MAGIC, _JSON = struct.Struct("<4sIIII"), b"glTF", 0x4E4F534A
_SIZES = {5120: 1, 5121: 1, 5122: 2, 5123: 2, 5125: 4, 5126: 4}
_WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT2": 4, "MAT3": 9, "MAT4": 16}


def check_gltf(path: Path, below: Below) -> None:
    """Check the counts of a file; a broken one is left to its reader.

    Args:
        below: reads the files that it refers to, and receives the pictures that replace those within the file.

    Raises:
        AssetError: there are too many parts or triangles, or the arrays are too large.
    """
    tree = _tree(path)
    if not isinstance(tree, dict):
        return
    nodes = _objects(tree, "nodes")
    check_parts(path, len(nodes), "nodes")
    uses = [node.get("mesh") for node in nodes]
    primitives = [_objects(mesh, "primitives") for mesh in _objects(tree, "meshes")]
    check_parts(path, sum(map(len, primitives)), "meshes")
    drawn_primitives = sum(len(primitives[use]) for use in uses if isinstance(use, int) and 0 <= use < len(primitives))
    check_parts(path, drawn_primitives, "meshes that its nodes show")
    for name in ("accessors", "bufferViews", "materials", "textures", "images"):
        check_parts(path, len(_objects(tree, name)), name)
    _refuse_deep(path, nodes)
    _check_pictures(path, tree, below)
    _check_arrays(path, tree)
    _check_uses(path, tree, [primitive for some in primitives for primitive in some])


def _tree(path: Path) -> object:
    """The JSON part of a file; None if it has none, which its reader reports.

    Raises:
        AssetError: it is damaged.
    """
    try:
        if path.suffix.lower() == ".gltf":
            return json.loads(path.read_bytes())
        with path.open("rb") as file:
            _, _, _, size, _ = _GLB.unpack(file.read(_GLB.size))
            return json.loads(file.read(size))
    except struct.error:
        return None
    except RecursionError:
        raise AssetError(path, "its JSON is nested too deeply") from None
    except ValueError as error:
        raise AssetError(path, f"its JSON is damaged: {error!s:.100}") from None


def with_pictures(content: bytes, pictures: Mapping[int, bytes]) -> bytes:
    """The content of a file with other pictures, PNG files by number."""
    binary = content.startswith(_MAGIC)
    size = _GLB.unpack_from(content)[3] if binary else len(content)
    begin = _GLB.size if binary else 0
    tree = json.loads(content[begin : begin + size])
    for number, image in enumerate(_objects(tree, "images")):
        if number in pictures:
            image.clear()
            image["uri"] = f"data:image/png;base64,{base64.b64encode(pictures[number]).decode()}"
    text = json.dumps(tree).encode()
    if not binary:
        return text
    text += b" " * (-len(text) % 4)
    rest = content[begin + size :]
    return _GLB.pack(_MAGIC, 2, _GLB.size + len(text) + len(rest), len(text), _JSON) + text + rest


def _check_pictures(path: Path, tree: dict[str, object], below: Below) -> None:
    """Find pictures within the file that take too much time or memory: the library opens and decodes them itself."""
    buffers: dict[int, bytes] = {}
    total = 0
    for number, image in enumerate(_objects(tree, "images")):
        data = _embedded(path, tree, image, buffers, below)
        total += len(data)
        if total > _OVERLAP * _MOST_BYTES:
            raise AssetError(path, "its pictures overlap too much")
        if not data or image.get("mimeType") == _NOT_OPENED:
            continue
        try:
            readable = readable_picture(data)
            if readable is not data:
                below.pictures[number] = readable
        except ValueError as error:
            below.pictures[number] = chequered()
            below.unusable[f"{number} of the file"] = str(error)


def _embedded(
    path: Path, tree: dict[str, object], image: dict[str, object], buffers: dict[int, bytes], below: Below
) -> bytes:
    """The content of a picture within the file; empty for one in another file, or if it is damaged."""
    uri = image.get("uri")
    if isinstance(uri, str):
        return _of_uri(uri)
    views, number = _objects(tree, "bufferViews"), image.get("bufferView")
    if not isinstance(number, int) or not 0 <= number < len(views):
        return b""
    view, all_buffers = views[number], _objects(tree, "buffers")
    index = view.get("buffer", 0)
    if not isinstance(index, int) or not 0 <= index < len(all_buffers):
        return b""
    if index not in buffers:
        uri = all_buffers[index].get("uri")
        if isinstance(uri, str) and not uri.startswith("data:"):
            with contextlib.suppress(FileNotFoundError):
                buffers[index] = below.get(unquote(uri))
        buffers.setdefault(index, _of_uri(uri) if isinstance(uri, str) else _binary(path))
    begin = _count(view, "byteOffset")
    return buffers[index][begin : begin + _count(view, "byteLength")]


def _of_uri(uri: str) -> bytes:
    head, separator, text = uri.partition(",")
    try:
        return base64.b64decode(text) if separator and head.startswith("data:") else b""
    except ValueError:
        return b""


def _binary(path: Path) -> bytes:
    """The binary part of a file."""
    with path.open("rb") as file:
        try:
            _, _, _, size, _ = _GLB.unpack(file.read(_GLB.size))
            file.seek(size + 8, 1)
        except (struct.error, OSError):
            return b""
        return file.read(_MOST_BYTES)


def _check_arrays(path: Path, tree: dict[str, object]) -> None:
    implicit = sum(_count(accessor) for accessor in _objects(tree, "accessors") if _is_implied(accessor))
    if implicit > _MOST_IMPLIED:
        raise AssetError(path, f"it has arrays of {implicit} items that are not in the file, at most {_MOST_IMPLIED}")
    buffers = sum(_count(buffer, "byteLength") for buffer in _objects(tree, "buffers"))
    if buffers > _MOST_BYTES:
        raise AssetError(
            path, f"its buffers have {buffers:,} bytes together, at most {_MOST_BYTES:,} are read: divide the model "
            "into several files",
        )  # fmt: skip
    views = sum(_count(view, "byteLength") for view in _objects(tree, "bufferViews"))
    arrays = sum(_bytes(accessor) for accessor in _objects(tree, "accessors") if "bufferView" in accessor)
    for what, size in (("buffer views", views), ("arrays", arrays)):
        if size > _OVERLAP * max(buffers, _MOST_IMPLIED):
            raise AssetError(path, f"its {what} have {size:,} bytes, its buffers {buffers:,}: they overlap too much")


def _check_uses(path: Path, tree: dict[str, object], primitives: list[dict[str, object]]) -> None:
    """Refuse primitives that use arrays again and again: each use becomes a mesh of its own."""
    counts = [_count(accessor) for accessor in _objects(tree, "accessors")]
    corners = again = 0
    used_numbers: set[int] = set()
    for primitive in primitives:
        attributes = primitive.get("attributes")
        places = attributes.get("POSITION") if isinstance(attributes, dict) else None
        order = primitive.get("indices", places)
        for number in {places, order}:
            if isinstance(number, int) and 0 <= number < len(counts):
                again += counts[number] if number in used_numbers else 0
                used_numbers.add(number)
        if isinstance(order, int) and 0 <= order < len(counts):
            corners += counts[order]
    check_triangles(path, [corners // 3])
    if again > _MOST_IMPLIED:
        raise AssetError(
            path, f"its meshes use {again:,} items of arrays again, at most {_MOST_IMPLIED:,}: show one mesh with "
            "several nodes instead",
        )  # fmt: skip


def _objects(table: dict[str, object], name: str) -> list[dict[str, object]]:
    entries = table.get(name)
    return [one for one in entries if isinstance(one, dict)] if isinstance(entries, list) else []


def _is_implied(accessor: dict[str, object]) -> bool:
    return "bufferView" not in accessor or "sparse" in accessor


def _count(table: dict[str, object], name: str = "count") -> int:
    count = table.get(name)
    return count if isinstance(count, int) and count > 0 else 0


def _bytes(accessor: dict[str, object]) -> int:
    kind, shape = accessor.get("componentType"), accessor.get("type")
    size = _SIZES.get(kind, 4) if isinstance(kind, int) else 4
    return _count(accessor) * size * (_WIDTHS.get(shape, 16) if isinstance(shape, str) else 16)


def _refuse_deep(path: Path, nodes: list[dict[str, object]]) -> None:
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
