"""The deformable bodies of MJCF files: how large they are, and the meshes and tetrahedra of files.

The parser of the engine would read their files itself. It gets their points and elements instead.
"""

from __future__ import annotations

import math
from itertools import islice
from typing import TYPE_CHECKING

import numpy as np

from morse.assets.meshfiles.reader import mesh_nodes
from morse.assets.nearby_files import FileRefusedError
from morse.system.regular_files import read_regular

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path
    from xml.etree.ElementTree import Element

    from numpy.typing import NDArray

#: largest number of vertices of all deformable bodies of a model, and largest file of one, bytes
MOST_VERTICES, MOST_BYTES = 10_000, 8 << 20
#: kinds of deformable bodies that are files, and the suffixes of these
FILES = {"mesh": (".stl", ".obj"), "gmsh": (".msh",)}
#: dimension to the type of the elements of Gmsh
_GMSH_TYPES = {1: 1, 2: 2, 3: 4}
_Parts = tuple["NDArray[np.float64]", "NDArray[np.intp]"]


def vertices_of(flex: Element) -> int:
    """Return the number of vertices that the text of an element asks for; that of a file is not known here."""
    listed = max(len(flex.get(word, "").split()) // 3 for word in ("point", "vertex", "node"))
    counted = 0.0
    for word in ("count", "cellcount"):
        numbers = [number for text in flex.get(word, "").split() if (number := _number(text)) >= 1.0]
        counted = max(counted, math.prod(min(number, 1e6) for number in numbers))
    return int(max(listed, counted, len(flex.get("body", "").split())))


def _number(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        return 0.0


def put_in(flex: Element, path: Path) -> None:
    """Replace the file of a ``flexcomp`` by its points and elements.

    Raises:
        ValueError, AssetError, MeshError, OSError: the file cannot be read.
    """
    kind, dimension = flex.get("type", "grid"), int(flex.get("dim", "2"))
    suffixes = FILES[kind]
    if path.suffix.lower() not in suffixes:
        raise FileRefusedError(f"files of type '{path.suffix:.20}' cannot be read; supported: {', '.join(suffixes)}")
    if kind == "mesh" and dimension != 2:
        raise ValueError("a mesh has two dimensions; a volume needs a file of Gmsh")
    if path.stat().st_size > MOST_BYTES:
        raise ValueError(f"its file is larger than {MOST_BYTES >> 20} MB")
    points, elements = _mesh(path) if kind == "mesh" else _gmsh(read_regular(path, MOST_BYTES), dimension)
    if not 0 < len(points) <= MOST_VERTICES or not len(elements):
        raise ValueError(f"it has {len(points)} vertices and {len(elements)} elements, expected up to {MOST_VERTICES}")
    flex.attrib.pop("origin", None)
    flex.set("type", "direct")
    flex.set("point", " ".join(map(repr, points.ravel().tolist())))
    flex.set("element", " ".join(map(str, elements.ravel().tolist())))


def _mesh(path: Path) -> _Parts:
    """The different vertices (V, 3) and the triangles (T, 3) of a file."""
    roots = mesh_nodes(path, libraries={})
    meshes = [node.mesh for root in roots for node in root.walk() if node.mesh is not None]
    corners = [mesh.vertices[mesh.triangles].reshape(-1, 3) for mesh in meshes]
    points, index = np.unique(np.concatenate([np.zeros((0, 3)), *corners]), axis=0, return_inverse=True)
    triangles = index.reshape(-1, 3)
    # not those that are lines
    whole = (
        (triangles[:, 0] != triangles[:, 1])
        & (triangles[:, 1] != triangles[:, 2])
        & (triangles[:, 2] != triangles[:, 0])
    )
    return points, triangles[whole]


def _gmsh(content: bytes, dimension: int) -> _Parts:
    """The points (V, 3) and the elements (E, dimension + 1) of a text file of Gmsh, of format 2.2 or 4.1."""
    if dimension not in _GMSH_TYPES:
        raise ValueError(f"it has {dimension} dimensions, expected 1, 2 or 3")
    sections = {
        name: body.split("$End", 1)[0]
        for part in content.decode("ascii", "replace").split("\n$")
        for name, _, body in [part.lstrip("$").partition("\n")]
        if not name.startswith("End")
    }
    sections = {name.strip(): body for name, body in sections.items()}
    version = sections.get("MeshFormat", "").split()[:2]
    if len(version) < 2 or version[0] not in ("2.2", "4.1") or version[1] != "0":
        raise ValueError("it is not a text file of Gmsh of format 2.2 or 4.1")
    is_old = version[0] == "2.2"
    nodes, elements = (iter(sections.get(name, "").split()) for name in ("Nodes", "Elements"))
    try:
        places = dict(_old_nodes(nodes) if is_old else _new_nodes(nodes))
        chosen = [
            corners
            for kind, corners in (_old_elements(elements) if is_old else _new_elements(elements))
            if kind == _GMSH_TYPES[dimension]
        ]
    except StopIteration:
        raise ValueError("the file is cut off") from None
    used = sorted({tag for corners in chosen for tag in corners})
    if not set(used) <= places.keys():
        raise ValueError("an element has a node that does not exist")
    number = {tag: place for place, tag in enumerate(used)}
    points = np.array([places[tag] for tag in used], dtype=np.float64).reshape(-1, 3)
    if not np.isfinite(points).all():
        raise ValueError("a node has coordinates that are not finite")
    return points, np.array([[number[tag] for tag in corners] for corners in chosen], np.intp).reshape(
        -1, dimension + 1
    )


_Node = tuple[int, tuple[float, ...]]
_Elements = tuple[int, tuple[int, ...]]
#: number of nodes of each type of elements of Gmsh that occurs in meshes of first order
_CORNERS = {1: 2, 2: 3, 3: 4, 4: 4, 5: 8, 6: 6, 7: 5, 15: 1}


def _next(words: Iterator[str], count: int) -> list[int]:
    numbers = [int(word) for word in islice(words, count)]
    if len(numbers) < count:
        raise StopIteration
    return numbers


def _place(words: Iterator[str]) -> tuple[float, ...]:
    return float(next(words)), float(next(words)), float(next(words))


def _counted(words: Iterator[str], count: int, most: int = MOST_BYTES) -> range:
    if not 0 <= count <= most:
        raise ValueError(f"it has {count} parts")
    return range(count)


def _old_nodes(words: Iterator[str]) -> list[_Node]:
    return [(int(next(words)), _place(words)) for _ in _counted(words, int(next(words)))]


def _new_nodes(words: Iterator[str]) -> list[_Node]:
    blocks, *_ = _next(words, 4)
    nodes: list[_Node] = []
    for _ in _counted(words, blocks):
        *_, parametric, count = _next(words, 4)
        if parametric:
            raise ValueError("its nodes have parameters")
        _counted(words, count)
        tags = _next(words, count)
        nodes += [(tag, _place(words)) for tag in tags]
    return nodes


def _old_elements(words: Iterator[str]) -> list[_Elements]:
    elements: list[_Elements] = []
    for _ in _counted(words, int(next(words))):
        _, kind, tags = _next(words, 3)
        _counted(words, tags)
        _next(words, tags)
        elements.append((kind, tuple(_next(words, _corners(kind)))))
    return elements


def _new_elements(words: Iterator[str]) -> list[_Elements]:
    blocks, *_ = _next(words, 4)
    elements: list[_Elements] = []
    for _ in _counted(words, blocks):
        *_, kind, count = _next(words, 4)
        for _ in _counted(words, count):
            _, *corners = _next(words, 1 + _corners(kind))
            elements.append((kind, tuple(corners)))
    return elements


def _corners(kind: int) -> int:
    if kind not in _CORNERS:
        raise ValueError(f"it has elements of the type {kind}; those of first order are supported")
    return _CORNERS[kind]
