"""Computes the collision shapes of a scene from meshes and the bounds in files and scripts."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from morse.assets import kept_shapes
from morse.assets.known_shapes import KnownShapes, content
from morse.assets.shapes import ConvexPart, Primitive, convex_parts, detect_primitive, fit_bounds, thickened
from morse.mathutils.portable import det, eigh, matmul
from morse.scene import Bounds, CollisionShape, PhysicsType, ShapeKind
from morse.scene.frames import rigid_frame

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from morse.scene import Mesh, Node, Scene

_SOLID = (PhysicsType.STATIC, PhysicsType.SENSOR, PhysicsType.OCCLUDER)
_FITTED = (Bounds.BOX, Bounds.SPHERE, Bounds.CYLINDER, Bounds.CONE, Bounds.CAPSULE)

#: minimum thickness of a hull, m, and as a share of its coordinates, which the engine rounds to 32 bits
_LEAST, _ROUNDING = 1e-4, 4e-6
#: points whose second moment, m^2, about a plane is smaller have no volume
_FLAT = 1e-8

_Key = tuple[int, tuple[float, ...], Bounds | None]

_EARLIER = KnownShapes()


def resolve_shapes(scene: Scene) -> list[str]:
    """Compute ``shapes`` of every node without shapes.

    Returns:
        Warnings about meshes that are too complex for exact collision shapes.
    """
    known: dict[_Key, list[CollisionShape]] = {}
    warnings: list[str] = []
    for node in scene.nodes():
        if node.shapes is None:
            node.shapes = _shapes_of(node, known, warnings)
    return warnings


def _shapes_of(node: Node, known: dict[_Key, list[CollisionShape]], warnings: list[str]) -> list[CollisionShape]:
    if not (node.body.moves or node.body.type in _SOLID):
        return []
    if node.mesh is None:
        return _without_mesh(node)
    stretch = rigid_frame(node).stretch
    numbers = tuple(round(value, 9) for row in stretch for value in row)
    key = (id(node.mesh), numbers, node.body.bounds)
    if key not in known:
        shapes, found = _shapes_of_mesh(node.mesh, numbers, node.body.bounds)
        known[key] = list(shapes)
        warnings += [f"'{node.name}': {text}" for text in found]
    return known[key]


def _shapes_of_mesh(
    mesh: Mesh, stretch: tuple[float, ...], bounds: Bounds | None
) -> tuple[tuple[CollisionShape, ...], tuple[str, ...]]:
    """The shapes of a stretched mesh, in its rigid frame, and warnings."""
    key = content(mesh), stretch, bounds
    found = _EARLIER.get(key)
    if found is None:
        simple = bounds in _FITTED
        found = None if simple else kept_shapes.get(key)
        if found is None:
            parts, warnings = _parts(mesh, np.reshape(stretch, (3, 3)), bounds)
            found = tuple(_made_solid(part).to_shape() for part in parts), tuple(warnings)
            if not simple:
                kept_shapes.put(key, found)
        _EARLIER.put(key, found)
    return found


def _without_mesh(node: Node) -> list[CollisionShape]:
    if (
        not node.body.moves
        or node.body.compound
        or any(child.body.collides for child in node.walk() if child is not node)
    ):
        return []
    return [CollisionShape(ShapeKind.SPHERE, (node.body.radius,))]


def _parts(
    mesh: Mesh, stretch: NDArray[np.float64], bounds: Bounds | None
) -> tuple[Sequence[Primitive | ConvexPart], list[str]]:
    vertices = matmul(np.asarray(mesh.vertices, dtype=np.float64), stretch.T)
    if len(vertices) == 0 or len(mesh.triangles) == 0:
        return [], []
    if bounds in _FITTED:
        return [fit_bounds(vertices, bounds)], []
    # mirroring flips the triangles
    triangles = mesh.triangles if det(stretch) >= 0.0 else mesh.triangles[:, ::-1]
    primitive = detect_primitive(vertices, triangles)
    if primitive is not None:
        return [primitive], []
    if bounds is Bounds.CONVEX_HULL:
        return [_hull(vertices)], []
    warnings: list[str] = []
    return convex_parts(vertices, triangles, warnings=warnings), warnings


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
