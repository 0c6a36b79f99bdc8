"""The deformable bodies of MJCF files: how large they are, and the meshes and tetrahedra of files.

The parser of the engine would read their files itself. It gets their points and elements instead.
"""

from __future__ import annotations

import math
from itertools import islice, pairwise
from typing import TYPE_CHECKING

import numpy as np

from morse.assets.nearby_files import FileRefusedError
from morse.system.regular_files import read_regular

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path
    from xml.etree.ElementTree import Element

    from numpy.typing import NDArray

#: largest number of vertices of all deformable bodies of a model, and largest file of one, bytes
MOST_VERTICES, MOST_BYTES = 10_000, 8 << 20
#: largest number of vertices that are bodies of their own: the time to compile them grows faster than their square
MOST_MOVING = 5_000
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


def moving_of(flex: Element) -> int:
    """Return how many vertices of a deformable body are bodies; those of a cage or a rigid body are not."""
    fixed = flex.get("rigid") == "true" or flex.get("dof") in ("trilinear", "quadratic")
    return 0 if fixed or flex.tag != "flexcomp" else vertices_of(flex)


def _number(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        return 0.0


def put_in(flex: Element, path: Path) -> None:
    """Replace the file of a ``flexcomp`` by its points and elements.

    Raises:
        ValueError, OSError: the file cannot be read.
    """
    kind, dimension = flex.get("type", "grid"), int(flex.get("dim", "2"))
    suffixes = FILES[kind]
    if path.suffix.lower() not in suffixes:
        raise FileRefusedError(f"files of type '{path.suffix:.20}' cannot be read; supported: {', '.join(suffixes)}")
    if kind == "mesh" and dimension != 2:
        raise ValueError("a mesh has two dimensions; a volume needs a file of Gmsh")
    if path.stat().st_size > MOST_BYTES:
        raise ValueError(f"its file is larger than {MOST_BYTES >> 20} MB")
    content = read_regular(path, MOST_BYTES)
    points, elements = _mesh(content, path.suffix.lower()) if kind == "mesh" else _gmsh(content, dimension)
    if not 0 < len(points) <= MOST_VERTICES or not len(elements):
        raise ValueError(f"it has {len(points)} vertices and {len(elements)} elements, expected up to {MOST_VERTICES}")
    flex.attrib.pop("origin", None)
    flex.set("type", "direct")
    flex.set("point", " ".join(map(repr, points.ravel().tolist())))
    flex.set("element", " ".join(map(str, elements.ravel().tolist())))


def _mesh(content: bytes, suffix: str) -> _Parts:
    """The different vertices (V, 3) and the triangles (T, 3) of a file, in its order: pins have their numbers."""
    places, corners = _stl(content) if suffix == ".stl" else _obj(content.decode("ascii", "replace"))
    if not np.isfinite(places).all():
        raise ValueError("a vertex has coordinates that are not finite")
    _, firsts, index = np.unique(places, axis=0, return_index=True, return_inverse=True)
    order = np.argsort(firsts)
    number = np.empty(len(order), np.intp)
    number[order] = np.arange(len(order))
    triangles = number[index.ravel()][corners]
    a, b, c = triangles.T
    # not those that are lines
    return places[firsts[order]], triangles[(a != b) & (b != c) & (c != a)]


def _stl(content: bytes) -> _Parts:
    """The corners (3 T, 3) of the triangles of a binary file or of a text, and the numbers of these (T, 3)."""
    count = int.from_bytes(content[80:84], "little")
    if len(content) == 84 + 50 * count:
        kind = np.dtype([("normal", "<f4", 3), ("corners", "<f4", 9), ("spare", "<u2")])
        places = np.frombuffer(content, kind, count, 84)["corners"].reshape(-1, 3).astype(np.float64)
    else:
        words = content.decode("ascii", "replace").split()
        rows = [[float(one) for one in words[at + 1 : at + 4]] for at, word in enumerate(words) if word == "vertex"]
        if len(rows) % 3 or any(len(row) != 3 for row in rows):
            raise ValueError("it is cut off")
        places = np.array(rows, np.float64).reshape(-1, 3)
    return places, np.arange(len(places)).reshape(-1, 3)


def _obj(text: str) -> _Parts:
    """The vertices (V, 3) of a file, and the triangles (T, 3); polygons are divided into fans."""
    places: list[list[float]] = []
    triangles: list[list[int]] = []
    for line in text.splitlines():
        word, *rest = line.split() or [""]
        if word == "v":
            places.append([float(one) for one in [*rest, "nan", "nan", "nan"][:3]])
        elif word == "f":
            numbers = [int(one.partition("/")[0]) for one in rest]
            if not all(0 < abs(number) <= len(places) for number in numbers):
                raise ValueError("a face has a vertex that does not exist")
            polygon = [number - 1 if number > 0 else len(places) + number for number in numbers]
            triangles += [[polygon[0], one, other] for one, other in pairwise(polygon[1:])]
    return np.array(places, np.float64).reshape(-1, 3), np.array(triangles, np.intp).reshape(-1, 3)


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
