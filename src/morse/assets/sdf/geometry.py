"""The shapes of links as nodes: what is seen, and what collides; terrains from pictures of heights."""

from __future__ import annotations

import itertools
import math
from typing import TYPE_CHECKING

import mapbox_earcut
import numpy as np

from morse.assets import solids
from morse.assets.errors import AssetError
from morse.assets.gazebo.values import ValueMistakeError, boolean, friction_of, number, text_of, vector
from morse.assets.meshfiles.reader import MeshError, mesh_nodes
from morse.assets.mjcf.heights import height_mesh
from morse.assets.nearby_files import FileRefusedError
from morse.assets.pictures import usable_picture
from morse.assets.polygons import with_texture_coordinates
from morse.assets.sdf.files import NotDownloadedError, find_file
from morse.mathutils import Vector
from morse.scene import BodySettings, Bounds, CollisionShape, Material, Mesh, Node, NodeKind, PhysicsType, ShapeKind
from morse.system.pictures import opened
from morse.system.regular_files import read_regular

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path
    from xml.etree.ElementTree import Element

    from numpy.typing import NDArray

    from morse.assets.sdf.materials import Materials
    from morse.mathutils import Matrix
    from morse.scene import Library

    Ring = NDArray[np.float64]


#: bytes of a picture; points along a side, of which larger pictures show every second, third, ... one
_MOST_BYTES, _MOST_POINTS = 128 << 20, 513
#: thickness below the lowest point, m
_GROUND = 1.0


def height_node(element: Element, path: Path, name: str, materials: Materials, *, is_solid: bool) -> Node:
    """The node of an element ``heightmap``: the brightest pixel has the full height, the top of the picture is +Y.

    Raises:
        FileRefusedError: the picture does not exist, or must not be read.
        ValueMistakeError: it is not a picture.
    """
    size, place = vector(element, "size", (1.0, 1.0, 1.0)), vector(element, "pos", (0.0, 0.0, 0.0))
    if min(size) <= 0.0:
        raise ValueMistakeError(f"its size is {text_of(element, 'size')[:60]!r}, expected positive numbers")
    heights = _heights(find_file(text_of(element, "uri"), path)) * size[2]
    node = Node(f"{name}_shape", NodeKind.MESH, source_name=f"{name}_shape", location=list(place))
    half = (0.5 * size[0], 0.5 * size[1], max(float(heights.max()), 1e-3), _GROUND)
    node.mesh = height_mesh(node.name, half, heights)
    if is_solid:
        node.shapes = [CollisionShape(ShapeKind.HEIGHT_FIELD, half, heights=heights)]
        return node
    texture = text_of(element, "texture/diffuse")
    image = materials.picture(texture, path) if texture and not texture.startswith("file://media") else None
    if image is not None:
        node.mesh = with_texture_coordinates(node.mesh)
        node.materials = [Material(name, (1.0, 1.0, 1.0, 1.0), image=image)]
    return node


def _heights(file: Path) -> NDArray[np.float64]:
    """Heights (R, C) from 0 to 1; rows along +Y."""
    try:
        picture = opened(usable_picture(read_regular(file, _MOST_BYTES)))
        picture.load()
        if picture.mode not in ("L", "I", "F", "I;16", "I;16B"):
            picture = picture.convert("L")
        pixels = np.asarray(picture, dtype=np.float64)
    except Exception as error:  # Pillow's readers raise many kinds of errors for damaged pictures
        raise ValueMistakeError(f"it is not a picture of heights: {error!s:.100}") from None
    step = max(1, -(-(max(pixels.shape) - 1) // (_MOST_POINTS - 1)))
    pixels = np.flipud(pixels)[::step, ::step]
    if min(pixels.shape) < 2 or not np.isfinite(pixels).all() or pixels.min() < 0.0:
        raise ValueMistakeError("it needs at least 2 x 2 pixels, none of them negative")
    return np.ascontiguousarray(pixels / max(float(pixels.max()), 1e-9))


#: corners of all polygons together
_MOST_CORNERS = 5000


def extruded(element: Element, name: str) -> Mesh:
    """The prism of an element ``polyline``; polygons within its first one are holes.

    Raises:
        ValueMistakeError: it has no area or no height, or too many corners.
    """
    height = number(element, "height", 1.0)
    polygons = [element, *element.findall("polyline")]
    rings = [ring for one in polygons if len(ring := _ring(one)) >= 3]
    if not rings or height <= 0.0:
        raise ValueMistakeError("it has no corners or no height")
    if sum(map(len, rings)) > _MOST_CORNERS:
        raise ValueMistakeError(f"it has more than {_MOST_CORNERS} corners")
    rings = [ring if (_area(ring) > 0.0) == (number == 0) else ring[::-1] for number, ring in enumerate(rings)]
    points = np.concatenate(rings)
    ends = np.cumsum([len(ring) for ring in rings]).astype(np.uint32)
    top = mapbox_earcut.triangulate_float64(points, ends).astype(np.int64).reshape(-1, 3)
    if not len(top):
        raise ValueMistakeError("its corners enclose no area")
    corners = points[top]
    areas = _cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    top[areas < 0.0] = top[areas < 0.0][:, ::-1]
    count = len(points)
    walls, begin = [], 0
    for ring in rings:
        one = begin + np.arange(len(ring))
        other = begin + np.roll(np.arange(len(ring)), -1)
        walls += [np.stack([one, other, other + count], axis=1), np.stack([one, other + count, one + count], axis=1)]
        begin += len(ring)
    triangles = np.concatenate([top + count, top[:, ::-1], *walls]).astype(np.int32)
    vertices = np.zeros((2 * count, 3), dtype=np.float32)
    vertices[:count, :2] = vertices[count:, :2] = points
    vertices[count:, 2] = height
    return Mesh(name, vertices, triangles, np.zeros(len(triangles), dtype=np.int32))


def _ring(element: Element) -> Ring:
    """The corners of a polygon (N, 2), without repeated ones."""
    corners: list[tuple[float, ...]] = []
    for point in element.findall("point")[: _MOST_CORNERS + 1]:
        if not (point.text or "").strip():
            continue
        x, y = vector(point, ".", (0.0, 0.0))
        if not corners or (x, y) != corners[-1]:
            corners.append((x, y))
    if len(corners) > 1 and corners[0] == corners[-1]:
        corners.pop()
    return np.array(corners, dtype=np.float64).reshape(-1, 2)


def _area(ring: Ring) -> float:
    return float(_cross(ring, np.roll(ring, -1, axis=0)).sum())


def _cross(a: Ring, b: Ring) -> NDArray[np.float64]:
    product: NDArray[np.float64] = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    return product


_FRICTIONS = ("surface/friction/ode/mu", "surface/friction/bullet/friction")


def settings_of(collision: Element, bounds: Bounds | None) -> BodySettings:
    """The settings of a shape that collides."""
    body = BodySettings(type=PhysicsType.STATIC, bounds=bounds)
    body.friction = friction_of(collision, _FRICTIONS)
    restitution = _number(collision, "surface/bounce/restitution_coefficient")
    if restitution is not None:
        body.restitution = min(max(restitution, 0.0), 1.0)
    body.ghost = boolean(collision, "surface/contact/collide_without_contact")
    return body


def _number(element: Element, path: str) -> float | None:
    try:
        value = number(element, path, -1.0)
    except ValueMistakeError:
        return None
    return value if value >= 0.0 else None


_GREY = (0.448, 0.448, 0.448, 1.0)
#: half size and thickness of the solid below an endless plane, m
_WIDE, _THICK = 1000.0, 10.0
_KINDS = (
    "box",
    "sphere",
    "cylinder",
    "capsule",
    "ellipsoid",
    "cone",
    "plane",
    "mesh",
    "polyline",
    "heightmap",
    "empty",
)


class Geometry:
    """Converts visuals and collisions; each mesh is read once.

    Args:
        warn: receives what is left out.
    """

    def __init__(self, materials: Materials, warn: Callable[[str], None]) -> None:
        self._materials, self._warn = materials, warn
        self._libraries: dict[Path, Library] = {}

    def node(self, element: Element, path: Path, name: str, pose: Matrix, *, is_static: bool) -> Node | None:
        """The node of an element ``visual`` or ``collision``; None, with a warning, if it is left out.

        Args:
            path: the file that contains the element.
            pose: 4x4, in the frame of the link.
            is_static: whether the link never moves.
        """
        is_solid = element.tag == "collision"
        geometry = element.find("geometry")
        kinds = [] if geometry is None else [child for child in geometry if isinstance(child.tag, str)]
        shape = next((child for child in kinds if child.tag in _KINDS), None)
        if shape is None or shape.tag == "empty":
            if shape is None:
                what = f"the shape <{kinds[0].tag}>" if kinds else "no shape"
                self._warn(f"'{name:.80}' has {what}; it is left out")
            return None
        try:
            node = self._shape(shape, path, name, is_solid=is_solid, is_static=is_static)
        except NotDownloadedError as error:
            self._warn(str(error))
            return None
        except (AssetError, FileRefusedError, MeshError, OSError, ValueMistakeError) as error:
            reason = error.message if isinstance(error, AssetError) else str(error)
            what = text_of(shape, "uri") or name
            self._warn(f"the {shape.tag} '{what:.120}' is left out: {reason}")
            return None
        outer = Node(name, source_name=name, location=list(pose.translation), rotation_euler=list(pose.to_euler()))
        outer.attach(node)
        material = None if is_solid else self._materials.material(element, path, name)
        for part in outer.walk():
            part.visible = not is_solid
            if part.mesh is None:
                continue
            if is_solid:
                part.body = settings_of(element, part.body.bounds)
            else:
                part.body, part.shapes = BodySettings(), []
                self._dress(part, material)
        return outer

    def _dress(self, part: Node, material: Material | None) -> None:
        assert part.mesh is not None
        if material is not None:
            if material.image is not None and part.mesh.uvs is None:
                part.mesh = with_texture_coordinates(part.mesh)
            part.materials = [material] * max(len(part.materials), 1)
        elif not part.materials:
            part.materials = [Material(part.name, _GREY)]

    # -- shapes ------------------------------------------------------------------------------

    def _shape(self, shape: Element, path: Path, name: str, *, is_solid: bool, is_static: bool) -> Node:
        if shape.tag == "mesh":
            return self._mesh(shape, path, name, is_static=is_static)
        if shape.tag == "heightmap":
            return height_node(shape, path, name, self._materials, is_solid=is_solid)
        node = Node(f"{name}_shape", NodeKind.MESH, source_name=f"{name}_shape")
        if shape.tag == "polyline":
            node.mesh = extruded(shape, node.name)
            node.body.bounds = None if is_static else Bounds.CONVEX_HULL
            return node
        if shape.tag == "plane":
            return _plane(node, shape, is_solid=is_solid)
        if shape.tag == "cone":
            radius, length = _sizes(shape, "radius", "length")
            node.mesh, node.scale = solids.cone(), [radius, radius, 0.5 * length]
            node.body.bounds = Bounds.CONE
            return node
        if shape.tag == "box":
            size = tuple(0.5 * side for side in _positive(shape, "size", vector(shape, "size", (1.0, 1.0, 1.0))))
        elif shape.tag == "sphere":
            size = _sizes(shape, "radius")
        elif shape.tag == "ellipsoid":
            size = _positive(shape, "radii", vector(shape, "radii", (1.0, 1.0, 1.0)))
        else:
            radius, length = _sizes(shape, "radius", "length")
            size = (radius, 0.5 * length)
        kind = ShapeKind(shape.tag)
        node.mesh, scale = solids.primitive(kind, size)
        node.scale, node.shapes = list(scale), [CollisionShape(kind, size)]
        return node

    def _mesh(self, shape: Element, path: Path, name: str, *, is_static: bool) -> Node:
        uri = text_of(shape, "uri")
        if not uri:
            raise ValueMistakeError("<mesh> has no <uri>")
        scale = vector(shape, "scale", (1.0, 1.0, 1.0))
        if not all(scale):
            raise ValueMistakeError("its scale is 0")
        node = Node(f"{name}_mesh", source_name=f"{name}_mesh", scale=list(scale))
        for part in mesh_nodes(find_file(uri, path), libraries=self._libraries):
            node.attach(part)
        submesh = shape.find("submesh")
        if submesh is not None:
            _only(node, text_of(submesh, "name"), is_centred=boolean(submesh, "center"))
        for part in node.walk():
            part.body = BodySettings(bounds=None if is_static else Bounds.CONVEX_HULL)
        return node


def _only(node: Node, name: str, *, is_centred: bool) -> None:
    """Keep one of the meshes of a file, at its place or with the centre of its bounding box at the origin.

    Raises:
        ValueMistakeError: there is no such mesh.
    """
    meshes = [part for part in node.walk() if part.mesh is not None]
    names = {part: {part.name, part.plain_name, part.mesh.name} for part in meshes if part.mesh is not None}
    matches = [part for part in meshes if name in names[part]]
    matches = matches or [part for part in meshes if any(one.startswith(name) for one in names[part])]
    if not matches:
        raise ValueMistakeError(f"it contains no mesh '{name:.60}'; it has {', '.join(p.name for p in meshes[:5])}")
    low, high = [math.inf] * 3, [-math.inf] * 3
    for part in meshes:
        if part not in matches:
            part.kind, part.mesh, part.materials = NodeKind.EMPTY, None, []
            continue
        assert part.mesh is not None
        place = node.world_matrix().inverted() @ part.world_matrix()
        ranges = zip(part.mesh.vertices.min(axis=0).tolist(), part.mesh.vertices.max(axis=0).tolist(), strict=True)
        for corner in itertools.product(*ranges):
            point = place @ Vector(corner)
            low, high = [min(p) for p in zip(low, point, strict=True)], [max(p) for p in zip(high, point, strict=True)]
    if is_centred:
        for part in node.children:
            part.location = [v - 0.5 * (a + b) for v, a, b in zip(part.location, low, high, strict=True)]


def _plane(node: Node, shape: Element, *, is_solid: bool) -> Node:
    """A plane that is shown in its size; what collides is endless, and solid below."""
    normal = Vector(vector(shape, "normal", (0.0, 0.0, 1.0)))
    if normal.length < 1e-9:
        raise ValueMistakeError("its normal is 0")
    width, depth = _positive(shape, "size", vector(shape, "size", (1.0, 1.0)))
    node.mesh = solids.plane()
    node.scale = [_WIDE, _WIDE, 1.0] if is_solid else [0.5 * width, 0.5 * depth, 1.0]
    node.rotation_euler = list(Vector((0.0, 0.0, 1.0)).rotation_difference(normal.normalized()).to_euler())
    half = 0.5 * _THICK
    node.shapes = [CollisionShape(ShapeKind.BOX, (_WIDE, _WIDE, half), (0.0, 0.0, -half))]
    return node


def _sizes(shape: Element, *tags: str) -> tuple[float, ...]:
    return tuple(_positive(shape, tag, (number(shape, tag, 1.0),))[0] for tag in tags)


def _positive(shape: Element, tag: str, values: tuple[float, ...]) -> tuple[float, ...]:
    if min(values) <= 0.0:
        raise ValueMistakeError(f"its {tag} is {text_of(shape, tag)[:60]!r}, expected positive numbers")
    return values
