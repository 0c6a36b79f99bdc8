"""Materials and visibility of nodes."""

from __future__ import annotations

import hashlib
from dataclasses import replace
from typing import TYPE_CHECKING
from weakref import WeakValueDictionary

from morse.scene.appearance import Image, Material

if TYPE_CHECKING:
    from morse.scene.mesh import Mesh
    from morse.scene.node import Node

_PLAIN = Material("")
#: the same images of all simulations, so that they are decoded once
_IMAGES: WeakValueDictionary[bytes, Image] = WeakValueDictionary()


def slot_materials(node: Node, mesh: Mesh) -> list[Material]:
    """The material of every slot that a mesh uses: that of the node, otherwise that of the mesh."""
    slot_count = int(mesh.material_index.max(initial=0)) + 1
    slots = []
    for slot in range(slot_count):
        own = node.materials[slot] if slot < len(node.materials) else None
        default = mesh.materials[slot] if slot < len(mesh.materials) else None
        slots.append(own or default or _PLAIN)
    return slots if node.image is None else [replace(material, image=node.image) for material in slots]


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
