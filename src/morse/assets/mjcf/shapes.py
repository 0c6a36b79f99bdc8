"""The shapes of an MJCF model as nodes."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from morse.assets import solids
from morse.assets.mjcf.heights import height_mesh
from morse.mathutils import Quaternion
from morse.scene import BodySettings, Bounds, CollisionShape, Material, Mesh, Node, NodeKind, PhysicsType, ShapeKind

if TYPE_CHECKING:
    from morse.assets.mjcf.model import GeomData

#: the viewers of MuJoCo hide shapes of this group and of higher groups
_HIDDEN = 3
#: half size of the plate that is shown for a plane: along its sides if it has no limit, and its half thickness, m
_ENDLESS, _PLATE = 50.0, 0.05
_KINDS = {
    "sphere": ShapeKind.SPHERE,
    "capsule": ShapeKind.CAPSULE,
    "ellipsoid": ShapeKind.ELLIPSOID,
    "cylinder": ShapeKind.CYLINDER,
    "box": ShapeKind.BOX,
}


def shape_node(geom: GeomData, name: str) -> Node:
    """Return the node of a shape; it is solid if the shape collides with anything."""
    node = Node(name, NodeKind.MESH, source_name=name, location=list(geom.position))
    node.rotation_euler = list(Quaternion(geom.quaternion).to_euler())
    red, green, blue, alpha = geom.color
    node.visible = geom.group < _HIDDEN and alpha > 0.0
    node.materials = [Material(name, (red, green, blue, alpha))]
    is_solid = any(geom.masks)
    if is_solid:
        node.body = BodySettings(type=PhysicsType.STATIC)
    else:
        node.shapes = []
    if geom.mesh is not None:
        vertices, triangles = geom.mesh
        node.mesh = Mesh(name, vertices, triangles, np.zeros(len(triangles), dtype=np.int32))
        node.body.bounds = Bounds.CONVEX_HULL
        return node
    if geom.heights is not None:
        node.mesh = height_mesh(name, geom.size, geom.heights)
        if is_solid:
            node.shapes = [CollisionShape(ShapeKind.HEIGHT_FIELD, geom.size, heights=geom.heights)]
        return node
    node.mesh, scale = _mesh(geom)
    node.scale = list(scale)
    if geom.kind == "plane":
        # the top of a plate
        axes = Quaternion(geom.quaternion).to_matrix()
        node.location = [place - scale[2] * row[2] for place, row in zip(geom.position, axes, strict=True)]
        if is_solid:
            node.shapes = [CollisionShape(ShapeKind.BOX, scale)]
    elif is_solid:
        node.shapes = [CollisionShape(_KINDS[geom.kind], geom.size)]
    return node


def plane_box(size: tuple[float, ...]) -> tuple[float, float, float]:
    """Return the half sizes of the plate that is shown for a plane; a size of 0 is no limit."""
    return size[0] or _ENDLESS, size[1] or _ENDLESS, _PLATE


def _mesh(geom: GeomData) -> tuple[Mesh, tuple[float, ...]]:
    """Return the mesh of a primitive, and its scale."""
    size = geom.size
    if geom.kind == "box":
        return solids.cube(), size
    if geom.kind == "plane":
        return solids.cube(), plane_box(size)
    if geom.kind == "ellipsoid":
        return solids.sphere(), size
    if geom.kind == "sphere":
        return solids.sphere(), (size[0],) * 3
    if geom.kind == "cylinder":
        return solids.cylinder(), (size[0], size[0], size[1])
    return solids.capsule(*size), (1.0, 1.0, 1.0)
