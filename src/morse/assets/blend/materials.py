"""Materials: node trees, the plain settings beside them, and the settings of Blender's old internal renderer."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.assets.blend.errors import Damage
from morse.assets.blend.old_materials import old_material
from morse.assets.blend.record import datablock_name
from morse.assets.blend.shaders import node_material
from morse.scene import Image, Material

if TYPE_CHECKING:
    from morse.assets.blend.file import BlendFile
    from morse.assets.blend.images import Images
    from morse.assets.blend.record import Record

_BACKFACE_CULLING = 1 << 2
_FACE_TEXTURES = 1 << 11
_MAX_SLOTS = 32_767


class Materials:
    """Reads each material once, for all meshes that use it."""

    def __init__(self, file: BlendFile, images: Images) -> None:
        self._file = file
        self._images = images
        self._read: dict[int, Material | None] = {}
        #: materials for images that are assigned to polygons (until 2.79)
        self.face_textured: set[Material] = set()

    def slots(self, holder: Record, field: str, count: int) -> list[Material | None]:
        """Return the materials of an array of pointers, e.g. the slots of a mesh."""
        return [self.at(address, holder) for address in holder.addresses(field, min(count, _MAX_SLOTS))]

    def image_at(self, address: int, holder: Record) -> Image | None:
        """The image at an address, or None."""
        record = holder.at(address, "Image")
        return None if record is None or record.block.code != "IM" else self._images.image(record)

    def at(self, address: int, holder: Record) -> Material | None:
        """The material at an address, or None for an empty slot."""
        if not address:
            return None
        if address not in self._read:
            block = self._file.block(address, holder.block.owner)
            index = self._file.dna.index("Material")
            if block is None or block.code != "MA" or index is None:
                self._read[address] = None
            else:
                self._read[address] = self._material(self._file.record(block, index))
        return self._read[address]

    def _material(self, record: Record) -> Material:
        name = datablock_name(record)
        try:
            material = node_material(name, record, self._images) if _uses_nodes(record) else None
            if material is not None:
                material.double_sided = not record.integer("blend_flag", 0) & _BACKFACE_CULLING
                return material
            if record.has("mtex"):
                material = old_material(name, record, self._images)
                if record.integer("mode", 0) & _FACE_TEXTURES:
                    self.face_textured.add(material)
                return material
            return plain_material(name, record)
        except Damage as damage:
            self._file.warn(f"the material '{name}' is damaged and is shown in grey: {damage}")
            return Material(name)


def _uses_nodes(record: Record) -> bool:
    return bool(record.integer("nodetree", 0)) and bool(record.integer("use_nodes", 0) or record.file.version >= 500)


def plain_material(name: str, record: Record) -> Material:
    """A material without nodes, as the viewport of Blender 2.80 and later shows it."""
    red, green, blue = (record.real(channel, 0.8) for channel in "rgb")
    return Material(
        name,
        color=(red, green, blue, min(max(record.real("a", 1.0), 0.0), 1.0)),
        metallic=record.real("metallic", 0.0),
        roughness=record.real("roughness", 0.4),
        specular=record.real("spec", 0.5),
        double_sided=not record.integer("blend_flag", 0) & _BACKFACE_CULLING,
    )
