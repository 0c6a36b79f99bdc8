"""Convex shapes for which the engine cannot compute a hull."""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING

import mujoco
import numpy as np

from morse.scene import CollisionShape, ShapeKind

if TYPE_CHECKING:
    from morse.scene import Node, Scene

logger = logging.getLogger(__name__)

_SMALLEST_HALF = 1e-3
_NAMED = 5


def replace_unusable_hulls(scene: Scene) -> bool:
    """Remove all convex shapes that the engine refuses, and log one warning with the names of the objects.

    Moving bodies need a shape for their inertia, so they get the box around the points instead.

    Returns:
        Whether any shape was removed.
    """
    unusable: dict[int, bool] = {}
    concerned: list[Node] = []
    for node in scene.nodes():
        bad_shapes = [shape for shape in node.shapes or () if _is_unusable(shape, unusable)]
        if bad_shapes:
            concerned.append(node)
            good_shapes = [shape for shape in node.shapes or () if shape not in bad_shapes]
            node.shapes = good_shapes + [_box_around(shape) for shape in bad_shapes if node.body.moves]
    if concerned:
        names = ", ".join(f"'{node.name}'" for node in concerned[:_NAMED])
        more = f" and {len(concerned) - _NAMED} more" if len(concerned) > _NAMED else ""
        logger.warning(
            "%s%s: parts of the mesh are too thin for the physics and are left out or collide as boxes; "
            "give the object a collision shape of its own (game physics bounds, or a property 'collision')",
            names,
            more,
            extra={"where": concerned[0].line},
        )
    return bool(concerned)


def _is_unusable(shape: CollisionShape, cache: dict[int, bool]) -> bool:
    if shape.kind is not ShapeKind.CONVEX:
        return False
    if id(shape) not in cache:
        cache[id(shape)] = _is_refused(shape)
    return cache[id(shape)]


def _is_refused(shape: CollisionShape) -> bool:
    spec = mujoco.MjSpec()
    vertices = np.ascontiguousarray(shape.vertices, dtype=np.float32).ravel()
    spec.add_mesh(name="hull", uservert=vertices, inertia=mujoco.mjtMeshInertia.mjMESH_INERTIA_CONVEX)
    spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_MESH, meshname="hull")
    try:
        spec.compile()
    except ValueError:
        return True
    return False


def _box_around(shape: CollisionShape) -> CollisionShape:
    assert shape.vertices is not None
    points = np.asarray(shape.vertices, dtype=np.float64)
    points = points[np.isfinite(points).all(axis=1)]
    low, high = (points.min(axis=0), points.max(axis=0)) if len(points) else (np.zeros(3), np.zeros(3))
    half, centre = np.maximum((high - low) / 2.0, _SMALLEST_HALF), (high + low) / 2.0
    return CollisionShape(ShapeKind.BOX, tuple(half.tolist()), tuple(centre.tolist()))
