"""Computes the collision shapes of a scene from meshes and the bounds in files and scripts."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from morse.assets.shape_cache import ShapeCache, content, load_shapes, store_shapes
from morse.assets.shapes import (
    DEFAULT_LIMIT,
    ConvexPart,
    Primitive,
    convex_parts,
    detect_primitive,
    few_parts,
    fit_bounds,
    thickened,
)
from morse.assets.shapes.coacd_parts import coacd_parts, coacd_version
from morse.assets.shapes.surface import clean_surface
from morse.mathutils.portable import det, eigh, matmul
from morse.scene import Bounds, CollisionShape, PhysicsType, ShapeKind
from morse.scene.frames import rigid_frame

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from numpy.typing import NDArray

    from morse.scene import Mesh, Node, Scene

_SOLID = (PhysicsType.STATIC, PhysicsType.SENSOR, PhysicsType.OCCLUDER, PhysicsType.KINEMATIC)
_FITTED = (Bounds.BOX, Bounds.SPHERE, Bounds.CYLINDER, Bounds.CONE, Bounds.CAPSULE)

#: minimum thickness of a hull, m, and as a share of its coordinates, which the engine rounds to 32 bits
_LEAST, _ROUNDING = 1e-4, 4e-6
#: points whose second moment, m^2, about a plane is smaller have no volume
_FLAT = 1e-8

#: parts of all meshes of a scene together; the first parts of a mesh do not count, and each mesh may have as many
_MOST_PARTS, _FREE_PARTS = 16_384, 64
#: shapes of a mesh that moves: each takes time while it touches others
_MOST_MOVING = 32
#: triangles of a mesh that moves, from which on its parts are computed once for all its sizes
_LARGE = 20_000
_UNSTRETCHED = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)
#: triangles of a mesh that are looked at first
_FIRST = 16
#: triangles of meshes that are shown with further scales, for each of which their parts are computed again
_MOST_SCALED = 1_000_000
#: shapes of a scene: the engine takes 0.1 ms and 2 kB for each
_MOST_SHAPES = 50_000

_Key = tuple[int, tuple[float, ...], Bounds | None, bool, bool]

_EARLIER = ShapeCache()


def resolve_shapes(scene: Scene) -> list[str]:
    """Compute ``shapes`` of every node without shapes; see `warnings_of_shapes`."""
    return [text for _, text in warnings_of_shapes(scene)]


def warnings_of_shapes(scene: Scene) -> list[tuple[Node, str]]:
    """Compute ``shapes`` of every node without shapes.

    Returns:
        Nodes with meshes that are too complex for exact collision shapes, and the warnings.

    Raises:
        ValueError: the scene has too many shapes, or too many scaled copies of large meshes.
    """
    resolving = _Resolving()
    inverted = _inverted_floors([node for node in scene.nodes() if node.shapes is None])
    count = 0
    for node in scene.nodes():
        if node.shapes is None:
            node.shapes = resolving.shapes_of(node, is_inverted=id(node) in inverted)
        count += len(node.shapes)
        if count > _MOST_SHAPES:
            raise ValueError(
                f"{_place(node)}: with it, the scene has more than {_MOST_SHAPES:,} collision shapes; join objects, "
                "give detailed ones a simple shape (bounds), or exclude them from collision"
            )
    return resolving.warnings


def prepare_moving(nodes: Iterable[Node]) -> None:
    """Compute the shapes that the meshes of an object get when it is added to a running scene, which then finds them.

    It may be called in any thread. The parts of a mesh of 300,000 triangles take more than 10 s.

    Args:
        nodes: those of a model, as they are in its file.
    """
    for node in nodes:
        if (mesh := node.mesh) is not None and node.body.bounds is None:
            _shapes_of_mesh(content(mesh), mesh, _stretch(node), None, _MOST_MOVING, is_inverted=False)


def _inverted_floors(nodes: Sequence[Node]) -> set[int]:
    """Return the ids of static meshes that only have triangles which face down, with nothing static below.

    These are floors whose triangles run the wrong way round: plates, which lie behind triangles, would carry too high.
    """
    fixed = [
        node for node in nodes if node.mesh is not None and node.body.type is PhysicsType.STATIC and not _moves(node)
    ]
    facing = [node for node in fixed if _faces_down(node)]
    if not facing:
        return set()
    bottoms = {id(node): float(_world_vertices(node)[:, 2].min(initial=np.inf)) for node in fixed}
    lowest = min(bottoms.values())
    return {id(node) for node in facing if bottoms[id(node)] <= lowest + _LEAST}


def _faces_down(node: Node) -> bool:
    mesh = node.mesh
    if mesh is None or not len(mesh.triangles) or not len(mesh.vertices):
        return False
    # the first triangles of most meshes decide
    for triangles in (mesh.triangles[:_FIRST], mesh.triangles):
        used, corners = np.unique(triangles, return_inverse=True)
        a, b, c = np.moveaxis(_world_vertices(node, used)[corners.reshape(-1, 3)], 1, 0)
        x, y = b - a, c - a
        areas = x[:, 0] * y[:, 1] - x[:, 1] * y[:, 0]
        if not (areas <= 0.0).all() or not (areas < 0.0).any():
            return False
    return True


def _world_vertices(node: Node, used: NDArray[np.integer] | slice = slice(None)) -> NDArray[np.float64]:
    """The vertices (N, 3) of a mesh in the world, m."""
    assert node.mesh is not None
    frame = rigid_frame(node)
    points = matmul(np.asarray(node.mesh.vertices, dtype=np.float64)[used], np.array(frame.stretch).T)
    turned: NDArray[np.float64] = matmul(points, np.array(frame.rotation).T) + np.array(frame.position)
    return turned


class _Resolving:
    """Computes the shapes of a scene, those of equal meshes once.

    Attributes:
        warnings: about meshes that are too complex.
    """

    def __init__(self) -> None:
        self.warnings: list[tuple[Node, str]] = []
        self._shapes_by_key: dict[_Key, list[CollisionShape]] = {}
        self._contents: dict[int, bytes] = {}
        self._parts = self._scale_count = 0

    def shapes_of(self, node: Node, *, is_inverted: bool = False) -> list[CollisionShape]:
        if not (node.body.moves or node.body.type in _SOLID):
            return []
        if node.mesh is None:
            return _without_mesh(node)
        numbers = _stretch(node)
        few = node.body.bounds is Bounds.DECOMPOSITION or (node.body.bounds is None and _moves(node))
        key = (id(node.mesh), numbers, node.body.bounds, few, is_inverted)
        if key not in self._shapes_by_key:
            # further meshes are divided into few parts when there are very many already
            limit = _MOST_MOVING if few else min(DEFAULT_LIMIT, max(_MOST_PARTS - self._parts, _FREE_PARTS))
            shapes, warnings = _shapes_of_mesh(
                self._content(node), node.mesh, numbers, node.body.bounds, limit, is_inverted=is_inverted
            )
            self._shapes_by_key[key] = list(shapes)
            self._parts += max(len(shapes) - _FREE_PARTS, 0)
            self.warnings += [(node, f"'{node.name}': {text}") for text in warnings]
        return self._shapes_by_key[key]

    def _content(self, node: Node) -> bytes:
        """The digest of the mesh of a node; a mesh whose shapes are computed again counts.

        Raises:
            ValueError: there are too many of these.
        """
        mesh = node.mesh
        assert mesh is not None
        if id(mesh) in self._contents:
            self._scale_count += len(mesh.triangles)
            if self._scale_count > _MOST_SCALED:
                raise ValueError(
                    f"{_place(node)}: collision shapes would be computed for more than {_MOST_SCALED:,} triangles of "
                    f"scaled copies; use fewer different scales of '{mesh.name}', give it a simple shape (bounds), or "
                    "exclude the copies from collision"
                )
        else:
            self._contents[id(mesh)] = content(mesh)
        return self._contents[id(mesh)]


def _moves(node: Node) -> bool:
    """Whether a node is a moving body, or a part of one."""
    while node.parent is not None and not _is_moved(node):
        node = node.parent
    return _is_moved(node)


def _is_moved(node: Node) -> bool:
    return node.body.moves or node.body.type is PhysicsType.KINEMATIC


def _stretch(node: Node) -> tuple[float, ...]:
    """How a mesh is stretched in its rigid frame, row by row."""
    # the sum with 0.0 turns -0.0 into 0.0, which has another name in the cache on disk
    return tuple(round(value, 9) + 0.0 for row in rigid_frame(node).stretch for value in row)


def _place(node: Node) -> str:
    return f"the object '{node.name:.80}'"


def _shapes_of_mesh(
    digest: bytes,
    mesh: Mesh,
    stretch: tuple[float, ...],
    bounds: Bounds | None,
    limit: int,
    *,
    is_inverted: bool,
) -> tuple[tuple[CollisionShape, ...], tuple[str, ...]]:
    """The shapes of a stretched mesh, in its rigid frame, and warnings; an inverted one is turned inside out."""
    own_digest = digest
    digest += b"inverted" if is_inverted else b""
    # with another limit, a mesh has other shapes
    digest += b"" if limit == DEFAULT_LIMIT else limit.to_bytes(4, "big")
    key = digest + (coacd_version().encode() if bounds is Bounds.DECOMPOSITION else b""), stretch, bounds
    shapes_and_warnings = _EARLIER.get(key)
    if shapes_and_warnings is None:
        simple = bounds in _FITTED
        shapes_and_warnings = None if simple else load_shapes(key)
        if shapes_and_warnings is None:
            parts: Sequence[Primitive | ConvexPart] | None = None
            warnings: list[str] = []
            is_moving = bounds is None and limit <= _MOST_MOVING
            if is_moving and len(mesh.triangles) >= _LARGE and stretch != _UNSTRETCHED:
                own, _ = _shapes_of_mesh(own_digest, mesh, _UNSTRETCHED, None, limit, is_inverted=is_inverted)
                parts = _stretched(own, np.reshape(stretch, (3, 3)))
            if parts is None:
                triangles = mesh.triangles[:, ::-1] if is_inverted else mesh.triangles
                parts, warnings = _parts(mesh.vertices, triangles, np.reshape(stretch, (3, 3)), bounds, limit)
            shapes_and_warnings = tuple(_made_solid(part).to_shape() for part in parts), tuple(warnings)
            if not simple:
                store_shapes(key, shapes_and_warnings)
        _EARLIER.put(key, shapes_and_warnings)
    return shapes_and_warnings


def _stretched(shapes: Sequence[CollisionShape], stretch: NDArray[np.float64]) -> list[ConvexPart] | None:
    """The parts of a large mesh in another size, which then takes no seconds.

    None if one of them is a primitive, which becomes something else by a stretch, or if the mesh becomes flat.
    """
    if any(shape.vertices is None for shape in shapes) or abs(det(stretch)) < _FLAT:
        return None
    return [ConvexPart(matmul(shape.vertices, stretch.T)) for shape in shapes if shape.vertices is not None]


def _without_mesh(node: Node) -> list[CollisionShape]:
    if (
        not node.body.moves
        or node.body.compound
        or any(child.body.collides for child in node.walk() if child is not node)
    ):
        return []
    return [CollisionShape(ShapeKind.SPHERE, (node.body.radius,))]


def _parts(
    points: NDArray[np.float32],
    triangles: NDArray[np.int32],
    stretch: NDArray[np.float64],
    bounds: Bounds | None,
    limit: int,
) -> tuple[Sequence[Primitive | ConvexPart], list[str]]:
    vertices = matmul(np.asarray(points, dtype=np.float64), stretch.T)
    if len(vertices) == 0 or len(triangles) == 0:
        return [], []
    if bounds in _FITTED:
        return [fit_bounds(vertices, bounds)], []
    # mirroring flips the triangles
    triangles = triangles if det(stretch) >= 0.0 else triangles[:, ::-1]
    if bounds is Bounds.CONVEX_HULL:
        return [detect_primitive(vertices, triangles) or _hull(vertices)], []
    if bounds is Bounds.DECOMPOSITION and coacd_version():
        surface = clean_surface(vertices, triangles)
        return coacd_parts(surface.vertices, surface.triangles, limit), []
    if limit <= _MOST_MOVING:
        return few_parts(vertices, triangles, limit), []
    warnings: list[str] = []
    return convex_parts(vertices, triangles, limit=limit, warnings=warnings), warnings


def _hull(vertices: NDArray[np.float64]) -> Primitive | ConvexPart:
    vertices = vertices[np.isfinite(vertices).all(axis=1)]
    points = np.unique(vertices.round(6), axis=0)
    spread = points - points.mean(axis=0)
    if eigh(matmul(spread.T, spread))[0][0] < _FLAT:
        return fit_bounds(vertices, Bounds.BOX)
    return ConvexPart(points)


def _made_solid(part: Primitive | ConvexPart) -> Primitive | ConvexPart:
    """Thicken a part if its volume would be lost by the rounding of the engine.

    Slivers between large faces become prisms of a few micrometres thickness, for which the engine cannot compute a
    hull.
    """
    if isinstance(part, Primitive):
        return part
    reach = float(np.abs(part.points).max())
    return ConvexPart(thickened(part.points, max(_LEAST, _ROUNDING * reach)))
