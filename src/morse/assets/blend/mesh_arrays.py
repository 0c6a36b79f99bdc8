"""The arrays of a mesh, from every generation of the file format.

Until 2.62 a mesh has faces of three or four corners (MFace); then polygons and loops in structs (MPoly, MLoop);
since 3.6 named attributes in custom data layers; since 5.0 attributes in a store of their own.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from morse.assets.blend.errors import Damage
from morse.assets.blend.layers import FLOAT2, MLOOPUV, MTFACE, Layer, attributes, column, layers, plain
from morse.assets.blend.polygons import Bools, Floats, Ints, Polygons, gather

if TYPE_CHECKING:
    from morse.assets.blend.blocks import Block
    from morse.assets.blend.file import Record

_SMOOTH = 1
_SHARP = 1 << 9


def read_polygons(mesh: Record) -> Polygons | None:
    """The polygons of a mesh, or None if it has none.

    Raises:
        Damage: its arrays contradict each other.
    """
    if _count(mesh, "totpoly", "faces_num"):
        return _Arrays(mesh).polygons()
    return _old_faces(mesh) if _count(mesh, "totface") else None


def _count(mesh: Record, *fields: str) -> int:
    count = mesh.integer(mesh.either(*fields), 0)
    if count < 0:
        raise Damage("it has a negative number of elements")
    return count


def _old_faces(mesh: Record) -> Polygons | None:
    count, total = _count(mesh, "totface"), _count(mesh, "totvert")
    points, faces = mesh.target("mvert"), mesh.target("mface")
    if points is None or faces is None:
        return None
    vertices = column(mesh, points, "MVert", "co", total).reshape(-1, 3).astype(np.float64)
    indices = np.stack([column(mesh, faces, "MFace", name, count) for name in ("v1", "v2", "v3", "v4")], axis=1)
    indices = indices.astype(np.int64)
    # a triangle has no fourth vertex, and no quad ends with vertex 0
    sizes = np.where(indices[:, 3] == 0, 3, 4)
    uvs = None
    for layer in sorted(layers(mesh, "fdata"), key=lambda layer: not layer.render):
        if layer.type == MTFACE:
            uvs = column(mesh, layer.data, "MTFace", "uv", count).reshape(-1, 2).astype(np.float64)
            break
    return gather(
        vertices,
        indices.ravel(),
        np.arange(count) * 4,
        sizes,
        column(mesh, faces, "MFace", "mat_nr", count).astype(np.int64),
        (column(mesh, faces, "MFace", "flag", count).astype(np.int64) & _SMOOTH) != 0,
        uvs,
        None,
    )


class _Arrays:
    """Finds each array where the version of the file keeps it."""

    def __init__(self, mesh: Record) -> None:
        self.mesh = mesh
        self.vertex_count = _count(mesh, "totvert", "verts_num")
        self.corner_count = _count(mesh, "totloop", "corners_num")
        self.polygon_count = _count(mesh, "totpoly", "faces_num")
        self.edge_count = _count(mesh, "totedge", "edges_num")
        self.vertex_layers = layers(mesh, "vdata", "vert_data")
        self.edge_layers = layers(mesh, "edata", "edge_data")
        self.polygon_layers = layers(mesh, "pdata", "face_data")
        self.corner_layers = layers(mesh, "ldata", "corner_data")
        self.attributes = attributes(mesh)

    def polygons(self) -> Polygons:
        starts, sizes = self._extents()
        return gather(
            self._vertices(),
            self._corners(),
            starts,
            sizes,
            self._materials(),
            self._smooth(),
            self._uvs(),
            self._sharp(),
        )

    def _named(self, among: list[Layer], name: str) -> Block | None:
        for layer in among:
            if layer.name == name:
                return layer.data
        known = self.attributes.get(name)
        return None if known is None else known.data

    def _structs(self, field: str, among: list[Layer], kind: int) -> Block | None:
        """An array of structs: by the field of the mesh, or by the type of its layer."""
        block = self.mesh.target(field) if self.mesh.has(field) else None
        return block or next((layer.data for layer in among if layer.type == kind), None)

    def _vertices(self) -> Floats:
        block = self._structs("mvert", self.vertex_layers, 0)
        if block is not None:
            return column(self.mesh, block, "MVert", "co", self.vertex_count).reshape(-1, 3).astype(np.float64)
        block = self._named(self.vertex_layers, "position")
        if block is None:
            raise Damage("its vertices are missing")
        return plain(self.mesh, block, "f4", self.vertex_count, 3).astype(np.float64)

    def _corners(self) -> Ints:
        block = self._structs("mloop", self.corner_layers, 26)
        if block is not None:
            return column(self.mesh, block, "MLoop", "v", self.corner_count).astype(np.int64)
        block = self._named(self.corner_layers, ".corner_vert")
        if block is None:
            raise Damage("the corners of its polygons are missing")
        return plain(self.mesh, block, "i4", self.corner_count).astype(np.int64)

    def _polygon_structs(self) -> Block | None:
        return self._structs("mpoly", self.polygon_layers, 25)

    def _extents(self) -> tuple[Ints, Ints]:
        field = self.mesh.either("poly_offset_indices", "face_offset_indices")
        block = self.mesh.target(field) if self.mesh.has(field) else None
        if block is not None:
            offsets = plain(self.mesh, block, "i4", self.polygon_count + 1).astype(np.int64)
            return offsets[:-1], np.diff(offsets)
        block = self._polygon_structs()
        if block is None:
            raise Damage("its polygons are missing")
        starts, sizes = (
            column(self.mesh, block, "MPoly", name, self.polygon_count) for name in ("loopstart", "totloop")
        )
        return starts.astype(np.int64), sizes.astype(np.int64)

    def _materials(self) -> Ints | None:
        block = self._named(self.polygon_layers, "material_index")
        if block is not None:
            return plain(self.mesh, block, "i4", self.polygon_count).astype(np.int64)
        block = self._polygon_structs()
        if block is None:
            return None
        index = self.mesh.file.dna.index("MPoly")
        name = self.mesh.file.record(block, index).either("mat_nr", "mat_nr_legacy")
        return column(self.mesh, block, "MPoly", name, self.polygon_count).astype(np.int64)

    def _smooth(self) -> Bools | None:
        block = self._named(self.polygon_layers, "sharp_face")
        if block is not None:
            return plain(self.mesh, block, "u1", self.polygon_count).astype(np.bool_) ^ True
        block = self._polygon_structs()
        if block is None:
            return np.ones(self.polygon_count, np.bool_)
        index = self.mesh.file.dna.index("MPoly")
        name = self.mesh.file.record(block, index).either("flag", "flag_legacy")
        flags = column(self.mesh, block, "MPoly", name, self.polygon_count).astype(np.int64)
        return (flags & _SMOOTH).astype(np.bool_)

    def _sharp(self) -> Ints | None:
        block = self._structs("medge", self.edge_layers, 3)
        flagged = self._named(self.edge_layers, "sharp_edge")
        if block is not None:
            ends = np.stack(
                [column(self.mesh, block, "MEdge", name, self.edge_count) for name in ("v1", "v2")], axis=-1
            )
            sharp = (column(self.mesh, block, "MEdge", "flag", self.edge_count).astype(np.int64) & _SHARP) != 0
        else:
            block = self._named(self.edge_layers, ".edge_verts")
            if block is None or flagged is None:
                return None
            ends = plain(self.mesh, block, "i4", self.edge_count, 2)
            sharp = np.zeros(self.edge_count, np.bool_)
        if flagged is not None:
            sharp = sharp | (plain(self.mesh, flagged, "u1", self.edge_count) != 0)
        chosen: Ints = ends[sharp].astype(np.int64)
        return chosen

    def _uvs(self) -> Floats | None:
        for kind in (MLOOPUV, FLOAT2):
            among = [layer for layer in self.corner_layers if layer.type == kind]
            for layer in sorted(among, key=lambda layer: not layer.render):
                if kind == MLOOPUV:
                    values = column(self.mesh, layer.data, "MLoopUV", "uv", self.corner_count).reshape(-1, 2)
                else:
                    values = plain(self.mesh, layer.data, "f4", self.corner_count, 2)
                return values.astype(np.float64)
        return None
