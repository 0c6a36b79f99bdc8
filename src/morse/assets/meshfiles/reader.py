"""Reads glTF, COLLADA, OBJ, STL and PLY files as libraries of nodes, after counting what they hold."""

from __future__ import annotations

import importlib.util
import io
import logging
import math
import re
import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from morse.assets.errors import AssetError
from morse.assets.formats import MESH_SUFFIXES, reader_of
from morse.assets.loader import instantiate
from morse.assets.meshfiles.files import SIZE_LIMIT, Below, readable
from morse.assets.meshfiles.gltf_counts import check_gltf, with_pictures
from morse.assets.meshfiles.surfaces import Surfaces
from morse.assets.triangle_limit import (
    MOST_MATERIALS,
    MOST_PARTS,
    check_corners,
    check_parts,
    check_stl,
    check_triangles,
)
from morse.assets.xml_files import read_xml
from morse.mathutils import Matrix
from morse.mathutils.portable import det, matmul, nearest_rotation
from morse.scene import Library, Node, NodeKind, PhysicsType
from morse.system.extras import install
from morse.system.pictures import run_no_programs
from morse.system.regular_files import read_regular

if TYPE_CHECKING:
    from collections.abc import Iterator
    from xml.etree.ElementTree import Element


#: elements with triangles, or with polygons that are divided into triangles
_PRIMITIVES = ("triangles", "polylist", "polygons", "trifans", "tristrips", "lines", "linestrips")
#: maximum number of instances of nodes inside of each other
_DEEPEST = 200


def check_instances(path: Path, root: Element) -> None:
    """Refuse a file whose scene shows too many nodes, meshes and triangles, before any of them is created.

    Raises:
        AssetError: there are too many, they contain each other, or there is no scene.
    """
    use = root.find("./{*}scene/{*}instance_visual_scene")
    scenes = {scene.get("id"): scene for scene in root.iterfind("./{*}library_visual_scenes/{*}visual_scene")}
    if use is None or _target(use) not in scenes:
        raise AssetError(path, "it has no scene: export it again with a <visual_scene>")
    geometries = {one.get("id"): _geometry(one) for one in root.iterfind("./{*}library_geometries/{*}geometry")}
    counts = _Counts(path, geometries)
    counts.nodes = {node.get("id"): node for node in root.iter() if _kind(node) == "node"}
    for primitive in root.iter():
        if _kind(primitive) in ("polylist", "polygons"):
            check_corners(path, _largest_polygon(primitive))
    check_parts(path, sum(meshes for meshes, _ in geometries.values()), "primitives")
    parts, triangles = counts.inside(scenes[_target(use)])
    check_parts(path, parts, "nodes and meshes that its scene shows")
    check_triangles(path, [triangles])


class _Counts:
    """Counts what elements show, each once: that of an instance is that of its target."""

    def __init__(self, path: Path, geometries: dict[str | None, tuple[int, int]]) -> None:
        self._path = path
        self._geometries = geometries
        self.nodes: dict[str | None, Element] = {}
        self._of_nodes: dict[str | None, tuple[int, int]] = {}
        self._above: list[str | None] = []

    def inside(self, element: Element) -> tuple[int, int]:
        """The nodes and meshes, and the triangles, below an element."""
        parts = triangles = 0
        for child in element:
            kind = _kind(child)
            if kind == "node":
                counts = self.inside(child)
                parts += 1
            elif kind == "instance_node":
                counts = self._instance(_target(child))
            elif kind in ("instance_geometry", "instance_controller"):
                counts = self._geometries.get(_target(child), (1, 0))
            else:
                continue
            parts, triangles = parts + counts[0], triangles + counts[1]
        # deep nesting makes numbers with thousands of digits
        return min(parts, 1000 * MOST_PARTS), min(triangles, 1 << 40)

    def _instance(self, name: str | None) -> tuple[int, int]:
        if name in self._above or len(self._above) > _DEEPEST:
            raise AssetError(self._path, f"its nodes contain each other, or instances deeper than {_DEEPEST}: '{name}'")
        if name not in self._of_nodes:
            self._above.append(name)
            target = self.nodes.get(name)
            parts, triangles = (0, 0) if target is None else self.inside(target)
            self._of_nodes[name] = parts + 1, triangles
            self._above.pop()
        return self._of_nodes[name]


def _geometry(geometry: Element) -> tuple[int, int]:
    """The number of meshes of a geometry, and an upper bound of the number of their triangles."""
    primitives = [element for element in geometry.iter() if _kind(element) in _PRIMITIVES]
    return len(primitives), sum(_corners(primitive) for primitive in primitives) // 3


def _corners(primitive: Element) -> int:
    corners = sum(len((list_.text or "").split()) for list_ in _lists(primitive)) // _width(primitive)
    # a polygon of n corners has n - 2 triangles
    return corners if _kind(primitive) == "triangles" else 3 * corners


def _largest_polygon(primitive: Element) -> int:
    """The number of corners of the largest polygon."""
    if _kind(primitive) == "polygons":
        return max((len((list_.text or "").split()) for list_ in _lists(primitive)), default=0) // _width(primitive)
    counts = (word for child in primitive if _kind(child) == "vcount" for word in (child.text or "").split())
    return max((int(word) for word in counts if word.isdecimal() and len(word) < 19), default=0)


def _width(primitive: Element) -> int:
    """The number of indices of a corner."""
    inputs = [child.get("offset", "0") for child in primitive if _kind(child) == "input"]
    return max((int(offset) for offset in inputs if offset.isdecimal()), default=0) + 1


def _lists(primitive: Element) -> Iterator[Element]:
    return (child for child in primitive.iter() if _kind(child) == "p")


def _kind(element: Element) -> str:
    tag: str = element.tag
    return tag.rpartition("}")[2]


def _target(use: Element) -> str:
    return use.get("url", "").removeprefix("#")


#: lines of OBJ files that begin an object, a group or a material; faces; vertices
_OBJ_PARTS = re.compile(rb"^[ \t]*(?:o|g|usemtl)[ \t]", re.MULTILINE)
_OBJ_MATERIALS = re.compile(rb"^[ \t]*usemtl[ \t]+(.*)$", re.MULTILINE)
_OBJ_FACES = re.compile(rb"^[ \t]*f[ \t].*$", re.MULTILINE)
_OBJ_VERTICES = re.compile(rb"^[ \t]*v[ \t]", re.MULTILINE)
#: maximum product of the parts of an OBJ file and its vertices: the reader marks for each part which it uses
_MOST_MARKS = 300_000_000
#: bytes of the header of a PLY file, and elements that it defines
_PLY_HEADER, _PLY_ELEMENTS = 1 << 16, 100
_PLY_ELEMENT = re.compile(rb"^[^\S\n]*element[^\S\n]+(\S+)[^\S\n]+(\d+)[^\S\n]*$", re.MULTILINE)


def check_counts(path: Path, below: Below) -> None:
    """Check the counts of a glTF, OBJ or PLY file.

    Args:
        below: reads the files that it refers to.

    Raises:
        AssetError: there are too many parts, triangles or corners, or an array is too large.
    """
    suffix = path.suffix.lower()
    if suffix == ".obj":
        _check_obj(path, path.read_bytes())
    elif suffix == ".ply":
        with path.open("rb") as file:
            _check_ply(path, file.read(_PLY_HEADER), path.stat().st_size)
    elif suffix in (".gltf", ".glb"):
        check_gltf(path, below)


def _check_obj(path: Path, text: bytes) -> None:
    text = text.replace(b"\r\n", b"\n").replace(b"\\\n", b"")
    parts = sum(1 for _ in _OBJ_PARTS.finditer(text))
    check_parts(path, parts, "objects, groups and materials")
    check_parts(path, len(set(_OBJ_MATERIALS.findall(text))), "materials", MOST_MATERIALS)
    vertices = sum(1 for _ in _OBJ_VERTICES.finditer(text))
    if parts * vertices > _MOST_MARKS:
        raise AssetError(
            path, f"its {parts:,} objects, groups and materials share {vertices:,} vertices: join some of the parts, "
            "or divide the file",
        )  # fmt: skip
    triangles = 0
    for face in _OBJ_FACES.finditer(text):
        corners = len(face[0].split()) - 1
        check_corners(path, corners)
        triangles += max(corners - 2, 0)
    check_triangles(path, [triangles])


def _check_ply(path: Path, header: bytes, size: int) -> None:
    begin, end, _ = header.partition(b"end_header")
    if not end:
        raise AssetError(path, f"its header does not end within {_PLY_HEADER} bytes")
    elements = _PLY_ELEMENT.findall(begin)
    if len(elements) > _PLY_ELEMENTS:
        raise AssetError(path, f"its header defines {len(elements)} elements, at most {_PLY_ELEMENTS} can be read")
    for name, number in elements:
        # an element takes a byte at least
        if int(number[:20]) > size:
            element_name = name.decode("ascii", "replace")
            raise AssetError(
                path, f"its header states {int(number[:20]):,} of '{element_name:.40}', its size is {size:,} bytes"
            )
        if name == b"face":
            check_triangles(path, [int(number)])


def collada_unit(path: Path) -> float:
    """Return the unit of a COLLADA file, m.

    Raises:
        AssetError: it is not COLLADA, shows too much, or the package that reads such files is not installed.
    """
    root = read_xml(path)
    if root.tag.rpartition("}")[2] != "COLLADA":
        raise AssetError(path, f"it is not COLLADA: it begins with <{root.tag:.60}>")
    if importlib.util.find_spec("collada") is None:
        raise AssetError(path, f"COLLADA files need another package: {install('collada')}")
    check_instances(path, root)
    unit_element = root.find("./{*}asset/{*}unit")
    text = "1" if unit_element is None else unit_element.get("meter", "1")
    try:
        unit = float(text)
    except ValueError:
        unit = math.nan
    if not 1e-9 < unit < 1e9:
        raise AssetError(path, f"its unit is {text[:60]!r} m, expected a positive number")
    return unit


#: glTF models face +Z with +Y up; models of MORSE face +X with +Z up
_FROM_GLTF = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
GLTF_SUFFIXES = (".gltf", ".glb")
#: largest number in a pose
_FARTHEST = 1e9
#: relative tolerance for parts of a matrix other than rotation and scale
_SHEAR = 1e-3


def read_meshes(path: str | Path, *, keeps_axes: bool = False) -> Library:
    """Read a file.

    glTF models are rotated so that their front is along +X and their top along +Z. OBJ, STL and PLY files do not define
    front and top: their axes are kept, and their unit is the metre. COLLADA files define their unit; their axes are
    also kept, as in the viewers of ROS. Files that a model refers to are only read from its folder and below.

    Args:
        keeps_axes: whether the axes of glTF are kept as well.

    Raises:
        AssetError: it is broken, too large or empty, or has too many triangles.
        OSError: it cannot be opened.
    """
    path = Path(path)
    if path.stat().st_size > SIZE_LIMIT:
        raise AssetError(path, f"it is larger than {SIZE_LIMIT >> 20} MiB")
    if path.suffix.lower() == ".stl":
        check_stl(path)
    below = Below(path.parent)
    try:
        check_counts(path, below)
        unit = collada_unit(path) if path.suffix.lower() == ".dae" else 1.0
        scene = _loaded(path, below)
        check_triangles(path, (len(getattr(part, "faces", ())) for part in scene.geometry.values()))
        library = _Reading(path, scene, keeps_axes=keeps_axes).library()
        for root in library.roots:
            root.location = [unit * value for value in root.location]
            root.scale = [unit * value for value in root.scale]
    except AssetError:
        raise
    except RecursionError:
        raise AssetError(path, "it is nested too deeply") from None
    except MemoryError:
        raise AssetError(path, "it needs more memory than is available") from None
    except IndexError as error:
        mistake = f"{error!s:.200}"
        raise AssetError(path, f"it refers to a vertex or another element that it does not have: {mistake}") from error
    except Exception as error:  # trimesh may raise any exception for a damaged file
        what = f" ({', '.join(below.refused[:3])} cannot be read)" if below.refused else ""
        raise AssetError(path, f"it cannot be read{what}: {type(error).__name__}: {error!s:.200}") from error
    for name, mistake in list(below.unusable.items())[:5]:
        library.warnings.append(f"the picture '{name:.80}' is replaced by a chequered pattern: {mistake}")
    if below.refused:
        names = ", ".join(f"'{name:.80}'" for name in below.refused[:5])
        library.warnings.append(f"files that are missing, or are outside of its folder, are ignored: {names}")
    return library


def _loaded(path: Path, below: Any) -> Any:
    import trimesh

    run_no_programs()
    quiet = logging.getLogger("trimesh")
    level = quiet.level
    quiet.setLevel(logging.CRITICAL)
    try:
        data = readable(path, read_regular(path, SIZE_LIMIT))
        if below.pictures:
            data = with_pictures(data, below.pictures)
        with io.BytesIO(data) as file, warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return trimesh.load_scene(
                file, file_type=path.suffix.lower().lstrip("."), resolver=below, process=False, allow_remote=False
            )
    finally:
        quiet.setLevel(level)


class _Reading:
    """Converts the graph of a trimesh scene to nodes."""

    def __init__(self, path: Path, scene: Any, *, keeps_axes: bool) -> None:
        self._path, self._scene = path, scene
        is_gltf = path.suffix.lower() in GLTF_SUFFIXES
        self._turn = _FROM_GLTF if is_gltf and not keeps_axes else np.eye(3)
        self._surfaces = Surfaces(self._turn, is_linear=is_gltf)
        self._names: set[str] = set()
        self._shears: list[str] = []

    def library(self) -> Library:
        graph = self._scene.graph
        base, parents = graph.base_frame, dict(graph.transforms.parents)
        nodes: dict[str, Node] = {}
        roots: list[Node] = []
        for frame in self._in_order(parents, base):
            parent = parents.get(frame, base)
            matrix, geometry = graph.get(frame, parent) if frame != parent else (np.eye(4), None)
            above = nodes.get(parent)
            node = self._node(str(frame), matrix, geometry)
            nodes[frame] = node
            if above is None:
                roots.append(node)
            else:
                above.attach(node)
        roots = [root for root in roots if any(node.mesh is not None for node in root.walk())]
        if not roots:
            raise AssetError(self._path, "it contains no mesh")
        library = Library(path=str(self._path), roots=roots, images=self._surfaces.images)
        library.warnings += self._surfaces.warnings[:5]
        if self._shears:
            library.warnings.append(f"sheared objects are shown without shear: {', '.join(self._shears[:5])}")
        return library

    def _in_order(self, parents: dict[Any, Any], base: object) -> list[Any]:
        """All frames except the base, parents first."""
        order: dict[Any, None] = {}
        for frame in sorted(parents, key=str):
            chain = []
            while frame in parents and frame != base and frame not in order and frame not in chain:
                chain.append(frame)
                frame = parents[frame]
            order.update(dict.fromkeys(reversed(chain)))
        return list(order)

    def _node(self, name: str, matrix: Any, geometry: str | None) -> Node:
        mesh = self._scene.geometry.get(geometry) if geometry is not None else None
        has_triangles = mesh is not None and len(getattr(mesh, "faces", ())) > 0
        node = Node(self._unique(name), NodeKind.MESH if has_triangles else NodeKind.EMPTY)
        node.source_name = node.name
        node.body.type = PhysicsType.AUTO  # the file has no physics settings: its role determines them
        if has_triangles:
            node.mesh = self._surfaces.mesh(str(geometry), mesh)
            node.materials = list(node.mesh.materials)
        self._place(node, np.asarray(matrix, dtype=float))
        return node

    def _unique(self, name: str) -> str:
        stem = name.strip()
        if not stem or stem.startswith("geometry_") or stem in (self._path.name, str(self._path)):
            stem = self._path.stem
        unique, number = stem, 0
        while unique in self._names:
            number += 1
            unique = f"{stem}.{number:03}"
        self._names.add(unique)
        return unique

    def _place(self, node: Node, matrix: Any) -> None:
        if matrix.shape != (4, 4) or not (np.abs(matrix) <= _FARTHEST).all():
            raise AssetError(
                self._path, f"the pose of '{node.name:.80}' is not a matrix of numbers up to {_FARTHEST:g}"
            )
        # the axes of each node are rotated in the same way as the axes of its mesh
        turn = matmul(matmul(self._turn, matrix[:3, :3]), self._turn.T)
        scale = np.linalg.norm(turn, axis=0)
        if det(turn) < 0.0:
            scale[2] = -scale[2]
        scale[scale == 0.0] = 1.0
        rotation = turn / scale
        if not np.allclose(matmul(rotation.T, rotation), np.eye(3), atol=_SHEAR):
            self._shears.append(node.name)
            rotation = nearest_rotation(rotation)
        node.location = matmul(self._turn, matrix[:3, 3]).tolist()
        node.rotation_euler = list(Matrix(rotation.tolist()).to_euler())
        node.scale = scale.tolist()


#: largest accepted coordinate, metres
_FARTHEST_VERTEX = 1e6


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
            if mesh.vertices.size and not abs(mesh.vertices).max() < _FARTHEST_VERTEX:
                raise MeshError(f"vertices of '{mesh.name}' are farther from the origin than {_FARTHEST_VERTEX:g} m")
        libraries[path] = library
    return [instantiate(root) for root in libraries[path].roots]
