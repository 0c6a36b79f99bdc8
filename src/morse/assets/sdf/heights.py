"""Terrains from pictures of heights."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from morse.assets.gazebo.values import ValueMistakeError, text_of, vector
from morse.assets.meshfiles.pictures import usable_picture
from morse.assets.mjcf.heights import height_mesh
from morse.assets.sdf.files import find_file
from morse.assets.texture_coordinates import with_texture_coordinates
from morse.scene import CollisionShape, Material, Node, NodeKind, ShapeKind
from morse.system.pictures import opened
from morse.system.regular_files import read_regular

if TYPE_CHECKING:
    from pathlib import Path
    from xml.etree.ElementTree import Element

    from numpy.typing import NDArray

    from morse.assets.sdf.materials import Materials

#: bytes of a picture; points along a side, of which larger pictures show every second, third, ... one
_MOST_BYTES, _MOST_POINTS = 128 << 20, 513
#: thickness below the lowest point, m
_THICK = 1.0


def height_node(element: Element, path: Path, name: str, materials: Materials, *, is_solid: bool) -> Node:
    """The node of an element ``heightmap``: the brightest pixel has the full height, the top of the picture is +Y.

    Raises:
        FileRefusedError: the picture does not exist, or must not be read.
        ValueMistakeError: it is no picture.
    """
    size, place = vector(element, "size", (1.0, 1.0, 1.0)), vector(element, "pos", (0.0, 0.0, 0.0))
    if min(size) <= 0.0:
        raise ValueMistakeError(f"its size is {text_of(element, 'size')[:60]!r}, expected positive numbers")
    heights = _heights(find_file(text_of(element, "uri"), path)) * size[2]
    node = Node(f"{name}_shape", NodeKind.MESH, source_name=f"{name}_shape", location=list(place))
    half = (0.5 * size[0], 0.5 * size[1], max(float(heights.max()), 1e-3), _THICK)
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
        raise ValueMistakeError(f"it is no picture of heights: {error!s:.100}") from None
    step = max(1, -(-(max(pixels.shape) - 1) // (_MOST_POINTS - 1)))
    pixels = np.flipud(pixels)[::step, ::step]
    if min(pixels.shape) < 2 or not np.isfinite(pixels).all() or pixels.min() < 0.0:
        raise ValueMistakeError("it needs at least 2 x 2 pixels, none of them negative")
    return np.ascontiguousarray(pixels / max(float(pixels.max()), 1e-9))
