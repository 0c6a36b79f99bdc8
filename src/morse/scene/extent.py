"""The space that the meshes of nodes occupy."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING
from weakref import WeakKeyDictionary

import numpy as np

from morse.mathutils import portable
from morse.mathutils.portable import matmul
from morse.scene.body import ShapeKind
from morse.scene.frames import rigid_frame

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import NDArray

    from morse.scene.body import CollisionShape
    from morse.scene.mesh import Mesh
    from morse.scene.node import Node
    from morse.scene.scene import Scene


Corners = tuple["NDArray[np.float64]", "NDArray[np.float64]"]


def extent(nodes: Iterable[Node], frame: Node | None = None) -> Corners | None:
    """Return the lower and the upper corner (3,) of the box around all vertices of nodes, m; None without vertices.

    Args:
        frame: the node whose frame is used for the corners; None for the world.
    """
    into = np.eye(4)
    if frame is not None:
        # without the scale of the frame, so that the unit is still the metre
        rigid = rigid_frame(frame)
        into[:3, :3] = np.array([list(row) for row in rigid.rotation]).T
        into[:3, 3] = matmul(-into[:3, :3], np.array(list(rigid.position)))
    low, high = np.full(3, np.inf), np.full(3, -np.inf)
    for node in nodes:
        if node.mesh is None or len(node.mesh.vertices) == 0:
            continue
        matrix = matmul(into, np.array([list(row) for row in node.world_matrix()]))
        points = matmul(node.mesh.vertices, matrix[:3, :3].T) + matrix[:3, 3]
        low, high = np.minimum(low, points.min(axis=0)), np.maximum(high, points.max(axis=0))
    return (low, high) if np.isfinite(low).all() else None


def visible_extent(root: Node) -> Corners | None:
    """Return the corners of the box around the visible meshes of a tree of nodes, see `extent`."""
    return extent(node for node in root.walk() if node.visible)


def corners(shape: CollisionShape, position: NDArray[np.float64], rotation: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return points (P, 3) in the frame of a body whose convex hull is the shape (approximately, if it is round).

    Args:
        position, rotation: (3,) and (3, 3) pose of the node of the shape in that frame.
    """
    if shape.kind is ShapeKind.CONVEX:
        assert shape.vertices is not None
        return np.asarray(matmul(shape.vertices, rotation.T) + position)
    if shape.kind is ShapeKind.BOX:
        signs = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], dtype=np.float64)
        own = signs * np.asarray(shape.size)
    elif shape.kind is ShapeKind.CYLINDER:
        turn = np.arange(24) * (math.pi / 12)
        ring = np.column_stack([portable.cos(turn), portable.sin(turn)]) * shape.size[0]
        own = np.vstack([np.column_stack([ring, np.full(24, h)]) for h in (-shape.size[1], shape.size[1])])
    else:
        radius = shape.size[0]
        up = radius + (shape.size[1] if shape.kind is ShapeKind.CAPSULE else 0.0)
        own = np.array([[radius, 0, 0], [-radius, 0, 0], [0, radius, 0], [0, -radius, 0], [0, 0, up], [0, 0, -up]])
    shape_rotation = matmul(rotation, np.reshape(shape.rotation, (3, 3)))
    return np.asarray(matmul(own, shape_rotation.T) + position + matmul(rotation, np.asarray(shape.position)))


def box_around(shape: CollisionShape, position: NDArray[np.float64], rotation: NDArray[np.float64]) -> tuple[
    NDArray[np.float64], NDArray[np.float64]
]:  # fmt: skip
    """Return the lower and the upper corner (3,), m, of the smallest box around a shape, along the axes of the world.

    Args:
        position, rotation: (3,) m, and (3, 3): pose of the node of the shape in the world.
    """
    if shape.kind is ShapeKind.CONVEX:
        assert shape.vertices is not None
        points = matmul(shape.vertices, rotation.T) + position
        return points.min(axis=0), points.max(axis=0)
    turn = matmul(rotation, np.reshape(shape.rotation, (3, 3)))
    centre = position + matmul(rotation, np.asarray(shape.position))
    size = np.asarray(shape.size)
    if shape.kind is ShapeKind.HEIGHT_FIELD:
        centre = centre + turn[:, 2] * (0.5 * (size[2] - size[3]))
        half = matmul(np.abs(turn), np.array([size[0], size[1], 0.5 * (size[2] + size[3])]))
    elif shape.kind is ShapeKind.BOX:
        half = matmul(np.abs(turn), size)
    elif shape.kind is ShapeKind.ELLIPSOID:
        half = np.sqrt(((turn * size) ** 2).sum(axis=1))
    elif shape.kind is ShapeKind.CYLINDER:
        along = np.abs(turn[:, 2])
        half = size[0] * np.sqrt(np.maximum(0.0, 1.0 - along**2)) + size[1] * along
    else:
        straight = size[1] if shape.kind is ShapeKind.CAPSULE else 0.0
        half = size[0] + straight * np.abs(turn[:, 2])
    return centre - half, centre + half


#: meshes with computed texture coordinates
_WRAPPED: WeakKeyDictionary[Mesh, Mesh] = WeakKeyDictionary()


def shown_mesh(node: Node) -> Mesh | None:
    """The mesh of a node as it is shown: with texture coordinates if the node has a texture of its own.

    A mesh without texture coordinates gets those of its bounding box: the texture covers each of its six sides once.
    """
    mesh = node.mesh
    if mesh is None or node.image is None or mesh.uvs is not None:
        return mesh
    if mesh not in _WRAPPED:
        corners = mesh.vertices[mesh.triangles]
        low = mesh.vertices.min(axis=0, initial=0.0)
        size = np.maximum(mesh.vertices.max(axis=0, initial=0.0) - low, np.float32(1e-9))
        normals = np.abs(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) / size)
        axes = np.array([[1, 2], [0, 2], [0, 1]])[normals.argmax(axis=1)]
        uvs = np.take_along_axis((corners - low) / size, axes[:, None, :], axis=2)
        _WRAPPED[mesh] = replace(mesh, uvs=uvs.astype(np.float32))
    return _WRAPPED[mesh]


#: m: a surface is flat, and wider than a basin that only stands in the world
_FLAT, _WIDE = 0.1, 5.0


def water_level(scene: Scene) -> float | None:
    """Return the height of the water in the world, m; None without water.

    Water is a flat object of the world whose name begins with ``Water`` or ``Sea``.
    """
    for root in scene.roots:
        if root.mesh is None or not root.plain_name.lower().startswith(("water", "sea")):
            continue
        corners = visible_extent(root)
        if corners is None:
            continue
        low, high = corners
        if high[2] - low[2] < _FLAT and min(high[0] - low[0], high[1] - low[1]) > _WIDE:
            return float(high[2])
    return None
