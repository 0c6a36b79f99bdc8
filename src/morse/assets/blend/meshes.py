"""Meshes of a file as triangles."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from morse.assets.blend.errors import Damage
from morse.assets.blend.file import datablock_name
from morse.assets.blend.mesh_arrays import read_polygons
from morse.assets.blend.normals import corner_normals
from morse.assets.blend.triangulate import triangulate
from morse.scene import Mesh

if TYPE_CHECKING:
    from morse.assets.blend.file import Record
    from morse.assets.blend.materials import Materials
    from morse.assets.blend.polygons import Polygons
    from morse.scene import Material

_AUTO_SMOOTH = 1 << 5
_MAX_SLOTS = 32_767


class Meshes:
    """Reads each mesh once, however many objects show it."""

    def __init__(self, materials: Materials) -> None:
        self._materials = materials
        self._read: dict[tuple[int, float | None], Mesh | None] = {}

    def mesh(self, record: Record, crease: float | None = None) -> Mesh | None:
        """The triangles of a mesh, or None if it has none.

        Args:
            record: the mesh.
            crease: angle (rad) above which an edge is sharp, where a modifier of the object says so.
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
        slots = self._materials.slots(record, "mat", min(record.integer("totcol", 0), _MAX_SLOTS))
        auto_smooth = record.integer("flag", 0) & _AUTO_SMOOTH
        if record.file.version < 401 and not auto_smooth and crease is None:
            # so long, sharp edges mattered only where the mesh or a modifier asked for them
            polygons.sharp = polygons.sharp[:0]
        elif auto_smooth and crease is None and record.file.version < 401:
            crease = _threshold(record)
        return build(datablock_name(record), polygons, crease, tuple(slots))


def _threshold(record: Record) -> float:
    field = record.struct.fields.get("smoothresh")
    value = record.real("smoothresh", np.pi)
    # degrees in a short integer until 2.63
    return float(np.radians(value)) if field is not None and field.numpy.endswith("i2") else value


def build(name: str, polygons: Polygons, crease: float | None, materials: tuple[Material | None, ...]) -> Mesh:
    """Triangles, with normals if a polygon is smooth."""
    corners, owner = triangulate(polygons)
    normals = corner_normals(polygons, crease)
    used, vertices = np.unique(polygons.corners[corners], return_inverse=True)
    return Mesh(
        name=name,
        vertices=np.ascontiguousarray(polygons.vertices[used], dtype=np.float32),
        triangles=vertices.reshape(-1, 3).astype(np.int32),
        material_index=np.clip(polygons.materials[owner], 0, max(len(materials) - 1, 0)).astype(np.int32),
        uvs=None if polygons.uvs is None else polygons.uvs[corners].astype(np.float32),
        normals=None if normals is None else normals[corners].astype(np.float32),
        materials=materials,
    )
