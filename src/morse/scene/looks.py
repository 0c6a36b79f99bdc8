"""Materials and visibility of nodes."""

from __future__ import annotations

import hashlib
from dataclasses import replace
from typing import TYPE_CHECKING
from weakref import WeakKeyDictionary, WeakValueDictionary

import numpy as np

from morse.scene.appearance import Image, Material

if TYPE_CHECKING:
    from morse.scene.mesh import Mesh
    from morse.scene.node import Node

_PLAIN = Material("")
#: the same images of all simulations, so that they are decoded once; and meshes with computed texture coordinates
_IMAGES: WeakValueDictionary[bytes, Image] = WeakValueDictionary()
_WRAPPED: WeakKeyDictionary[Mesh, Mesh] = WeakKeyDictionary()


def slot_materials(node: Node, mesh: Mesh) -> list[Material]:
    """The material of every slot that a mesh uses: that of the node, otherwise that of the mesh."""
    slot_count = int(mesh.material_index.max(initial=0)) + 1
    slots = []
    for slot in range(slot_count):
        own = node.materials[slot] if slot < len(node.materials) else None
        default = mesh.materials[slot] if slot < len(mesh.materials) else None
        slots.append(own or default or _PLAIN)
    return slots if node.image is None else [replace(material, image=node.image) for material in slots]


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


def shared_image(name: str, data: bytes, mime: str) -> Image:
    """Return an image; the same object for the same bytes."""
    key = hashlib.blake2b(data, digest_size=16).digest()
    image = _IMAGES.get(key)
    if image is None:
        image = _IMAGES[key] = Image(name, data, mime)
    return image


def is_shown(node: Node, visible: bool) -> bool:
    """Whether a node is visible.

    Args:
        visible: whether its object is visible; the property ``visible`` can also hide it.
    """
    return visible and node.properties.get("visible", True) not in (0, "0", "false", "False")
