"""Texture coordinates of meshes that have none."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING
from weakref import WeakKeyDictionary

import numpy as np

if TYPE_CHECKING:
    from morse.scene.mesh import Mesh
    from morse.scene.node import Node

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
