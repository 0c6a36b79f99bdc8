"""Materials of Blender's internal renderer, which the game engine also used (until 2.79)."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.scene import Image, Material

if TYPE_CHECKING:
    from morse.assets.blend.images import Images
    from morse.assets.blend.record import Record

_SHADELESS, _TRANSPARENT = 1 << 2, 1 << 16
_MAP_COLOR = 1
_IMAGE_TEXTURE = 8
_BACKFACE_CULLING = 16


def old_material(name: str, record: Record, images: Images) -> Material:
    """A material with diffuse and specular settings and texture slots."""
    mode = record.integer("mode", 0)
    red, green, blue = (_share(record.real(channel, 0.8)) for channel in "rgb")
    alpha = _share(record.real("alpha", 1.0)) if mode & _TRANSPARENT else 1.0
    specular = _share(record.real("spec", 0.5))
    image = color_texture(record, images)
    if image is not None:
        # the texture replaces the colour
        red = green = blue = 1.0
    emit = max(record.real("emit", 0.0), 0.0)
    culls = record.has("game") and record.part("game").integer("flag", 0) & _BACKFACE_CULLING
    return Material(
        name,
        color=(red, green, blue, alpha),
        roughness=_roughness(specular, record.integer("har", 50)),
        emission=(red * emit, green * emit, blue * emit),
        specular=specular,
        image=image,
        shadeless=bool(mode & _SHADELESS),
        double_sided=not culls,
    )


def _roughness(specular: float, hardness: int) -> float:
    """The roughness whose highlight is as wide as that of a Blinn exponent: ``alpha^2 = 2 / (n + 2)``.

    Without specular light there is no highlight, for any exponent.
    """
    width: float = (2.0 / (max(hardness, 1) + 2.0)) ** 0.25
    return 1.0 - specular * (1.0 - width)


def color_texture(record: Record, images: Images) -> Image | None:
    """The image of the first texture slot that colours the surface."""
    for address in record.array("mtex"):
        slot = record.at(address, "MTex")
        if slot is None or not slot.integer("mapto", 0) & _MAP_COLOR:
            continue
        texture = slot.follow("tex", "Tex")
        if texture is None or texture.integer("type", 0) != _IMAGE_TEXTURE:
            continue
        source = texture.follow("ima", "Image")
        image = None if source is None else images.image(source)
        if image is not None:
            return image
    return None


def _share(value: float) -> float:
    return min(max(value, 0.0), 1.0)
