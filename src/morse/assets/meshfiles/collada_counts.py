"""How much a COLLADA file shows: nodes and geometries may be used any number of times, also by each other."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.assets.errors import AssetError
from morse.assets.triangle_limit import MOST_PARTS, check_corners, check_parts, check_triangles

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path
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
