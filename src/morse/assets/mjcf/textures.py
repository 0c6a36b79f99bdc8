"""Textures of MJCF files: the engine gets one pixel for each; pictures are made of what the file says."""

from __future__ import annotations

import io
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from morse.assets.pictures import Pictures, usable_picture
from morse.scene import Image
from morse.system.pictures import opened

if TYPE_CHECKING:
    from collections.abc import Callable
    from xml.etree.ElementTree import Element

    from numpy.typing import NDArray

#: attributes that name files: the only one, or that of a side of a cube, whose picture is used for all sides
_FILES = ("file", "fileright", "fileleft", "fileup", "filedown", "filefront", "fileback")
#: width and height of a pattern, px
_SIDE = 256


@dataclass(slots=True)
class Texture:
    """A picture or a pattern.

    Attributes:
        attributes: those of its element.
        data: the content of its file, or None.
        is_lost: whether its file is left out.
    """

    name: str
    attributes: dict[str, str]
    data: bytes | None = None
    is_lost: bool = False


def take_textures(
    root: Element, textures: list[Texture], read: Callable[[str, str | None], bytes], origin: str
) -> list[str]:
    """Replace each texture of a model by one pixel, whose colour is its number, and return what is left out.

    Args:
        textures: those of models that attach each other; the textures of this one are added.
        read: returns the content of a file, from its name and the file that names it.
        origin: attribute with the file that contains an element.
    """
    losses, names = [], set()
    for assets in root.iter("asset"):
        for element in assets.findall("texture"):
            attributes = dict(element.attrib)
            file = next((attributes[name] for name in _FILES if attributes.get(name)), None)
            texture = Texture(attributes.get("name") or Path((file or "").replace("\\", "/")).stem, attributes)
            if attributes.get("type") == "skybox" or not texture.name:
                assets.remove(element)
                continue
            if file is not None:
                try:
                    texture.data = usable_picture(read(file, attributes.get(origin)))
                except (OSError, ValueError) as error:
                    losses.append(f"the texture '{file:.200}' is left out: {error}")
                    texture.is_lost = True
            number = len(textures)
            textures.append(texture)
            names.add(texture.name)
            color = f"{(number & 255) / 255} {(number >> 8 & 255) / 255} {(number >> 16) / 255}"
            element.attrib.clear()
            element.attrib.update(name=texture.name, type="2d", builtin="flat", width="1", height="1", rgb1=color)
    for material in root.iter("material"):
        for layer in material.findall("layer"):
            if layer.get("role") in ("rgb", "rgba"):
                material.set("texture", layer.get("texture", ""))
            material.remove(layer)
        if material.get("texture") not in names:
            material.attrib.pop("texture", None)
    return losses


class TextureImages:
    """The images of textures, each made when it is first used.

    Attributes:
        pictures: converts them; its warnings name pictures that could not be converted.
    """

    def __init__(self, textures: list[Texture]) -> None:
        self._textures = textures
        self.pictures = Pictures()
        self._images: dict[int, Image | None] = {}

    def image(self, number: int) -> Image | None:
        """Return the image of a texture; None if its file is left out."""
        if number not in self._images:
            self._images[number] = self._made(self._textures[number])
        return self._images[number]

    def is_cube(self, number: int) -> bool:
        """Whether a texture is that of the sides of a cube, which is not repeated."""
        return self._textures[number].attributes.get("type", "cube") == "cube"

    def _made(self, texture: Texture) -> Image | None:
        from PIL import Image as Pillow

        if texture.is_lost:
            return None
        if texture.data is not None:
            return self.pictures.image(texture.name, opened(texture.data))
        file = io.BytesIO()
        Pillow.fromarray(_pattern(texture.attributes)).save(file, "PNG")
        return Image(texture.name, file.getvalue(), "image/png")


def _pattern(attributes: dict[str, str]) -> NDArray[np.uint8]:
    """(S, S, 3) the picture of a built-in texture."""
    one, two = _color(attributes.get("rgb1", ".8 .8 .8")), _color(attributes.get("rgb2", ".5 .5 .5"))
    x, y = np.meshgrid(np.arange(_SIDE), np.arange(_SIDE))
    share = np.zeros((_SIDE, _SIDE))
    kind = attributes.get("builtin", "none")
    if kind == "checker":
        share = ((x * 2 // _SIDE + y * 2 // _SIDE) % 2).astype(float)
    elif kind == "gradient":
        # from the first colour at the top to the second one at the bottom
        share = y / (_SIDE - 1.0)
    pixels = one + share[..., None] * (two - one)
    mark, line = attributes.get("mark", "none"), _SIDE // 128
    if mark == "edge":
        edge = np.minimum.reduce([x, y, _SIDE - 1 - x, _SIDE - 1 - y]) < line
        pixels[edge] = _color(attributes.get("markrgb", "0 0 0"))
    elif mark == "cross":
        cross = np.minimum(abs(x - _SIDE // 2), abs(y - _SIDE // 2)) < line
        pixels[cross] = _color(attributes.get("markrgb", "0 0 0"))
    return np.round(255.0 * np.clip(pixels, 0.0, 1.0)).astype(np.uint8)


def _color(text: str) -> NDArray[np.float64]:
    try:
        numbers = [float(word) for word in text.split()]
    except ValueError:
        numbers = []
    return np.array(numbers[:3] if len(numbers) >= 3 else (0.8, 0.8, 0.8))
