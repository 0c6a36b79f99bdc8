"""Meshes of a file as triangles."""

from __future__ import annotations

from dataclasses import replace
from math import pi, radians
from typing import TYPE_CHECKING

import numpy as np

from morse.assets.blend.errors import Damage
from morse.assets.blend.mesh_arrays import read_polygons
from morse.assets.blend.normals import corner_normals
from morse.assets.blend.record import datablock_name
from morse.assets.blend.triangulate import triangulate
from morse.scene import Material, Mesh

if TYPE_CHECKING:
    from morse.assets.blend.materials import Materials
    from morse.assets.blend.polygons import Floats, Polygons
    from morse.assets.blend.record import Record

_AUTO_SMOOTH = 1 << 5
_MAX_SLOTS = 32_767


class Meshes:
    """Reads each mesh once, for all objects that use it."""

    def __init__(self, materials: Materials) -> None:
        self._materials = materials
        self._read: dict[tuple[int, float | None], Mesh | None] = {}

    def mesh(self, record: Record, crease: float | None = None) -> Mesh | None:
        """The triangles of a mesh, or None if it has none.

        Args:
            record: the mesh.
            crease: angle above which an edge is sharp, rad, if a modifier of the object sets it.
        """
        key = (record.offset, crease)
        if key not in self._read:
            try:
                self._read[key] = self._mesh(record, crease)
            except Damage as damage:
                record.file.warn(f"the mesh '{datablock_name(record)}' is damaged and is left out: {damage}")
                self._read[key] = None
        return self._read[key]

    def _mesh(self, record: Record, crease: float | None) -> Mesh | None:
        polygons = read_polygons(record)
        if polygons is None or not len(polygons.sizes):
            return None
        # several meshes may refer to the same arrays
        record.file.spend(len(polygons.corners) // 20)
        slots = self._materials.slots(record, "mat", record.integer("totcol", 0))
        if polygons.pictures is not None:
            slots = self._picture_slots(record, polygons, slots)
        if crease is None and record.file.version >= 401:
            crease = pi
        elif crease is None and record.integer("flag", 0) & _AUTO_SMOOTH:
            # in these versions, sharp edges were used only if the mesh or a modifier enabled them
            crease = _threshold(record)
        return build(datablock_name(record), polygons, corner_normals(polygons, crease), tuple(slots))

    def _picture_slots(self, record: Record, polygons: Polygons, slots: list[Material | None]) -> list[Material | None]:
        """Assign materials to polygons with their own image.

        The game engine did so for polygons without a material, or with a material that uses the images of its polygons.
        """
        assert polygons.pictures is not None
        last = max(len(slots) - 1, 0)
        rows = np.stack([np.clip(polygons.materials, 0, last).astype(np.uint64), polygons.pictures], axis=1)
        pairs, which = np.unique(rows, axis=0, return_inverse=True)
        result = list(slots) or [None]
        for number, (slot, address) in enumerate(pairs[:_MAX_SLOTS].tolist()):
            material = result[slot]
            needs_pictures = material is None or (material.image is None and material in self._materials.face_textured)
            image = self._materials.image_at(address, record) if needs_pictures else None
            if image is not None:
                _, _, _, alpha = material.color if material else (1.0, 1.0, 1.0, 1.0)
                polygons.materials[which.ravel() == number] = len(result)
                with_texture = replace(material) if material else Material(image.name)
                with_texture.image, with_texture.color = image, (1.0, 1.0, 1.0, alpha)
                result.append(with_texture)
        return result


def _threshold(record: Record) -> float:
    """The angle (rad) from which edges are sharp."""
    field = record.struct.fields.get("smoothresh")
    value = record.real("smoothresh", pi)
    # degrees in a short integer until 2.6x
    return radians(value) if field is not None and field.numpy.endswith("i2") else value


def build(name: str, polygons: Polygons, normals: Floats | None, materials: tuple[Material | None, ...]) -> Mesh:
    """Triangles from polygons; `normals` (C, 3) are the normals of the corners, or None for flat shading."""
    corners, owner = triangulate(polygons)
    used_vertices, vertices = np.unique(polygons.corners[corners], return_inverse=True)
    return Mesh(
        name=name,
        vertices=np.ascontiguousarray(polygons.vertices[used_vertices], dtype=np.float32),
        triangles=vertices.reshape(-1, 3).astype(np.int32),
        material_index=np.clip(polygons.materials[owner], 0, max(len(materials) - 1, 0)).astype(np.int32),
        uvs=None if polygons.uvs is None else polygons.uvs[corners].astype(np.float32),
        normals=None if normals is None else normals[corners].astype(np.float32),
        materials=materials,
    )
