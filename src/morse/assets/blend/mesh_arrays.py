"""The arrays of a mesh, from every generation of the file format.

Until 2.62 a mesh has faces of three or four corners (MFace). Then it has polygons and corners in structs (MPoly,
MLoop). Since 3.6 it has named arrays of plain numbers, in custom data layers, and since 5.0 in attributes.
"""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from morse.assets.blend import layers as kinds
from morse.assets.blend.errors import Damage
from morse.assets.blend.layers import Layer, attributes, column, layers, named, plain, shown, values
from morse.assets.blend.polygons import Bools, Floats, Ints, Polygons, gather

if TYPE_CHECKING:
    from morse.assets.blend.blocks import Block
    from morse.assets.blend.record import Record

_SMOOTH = 1
_SHARP = 1 << 9


def read_polygons(mesh: Record) -> Polygons | None:
    """The polygons of a mesh, or None if it has none.

    Raises:
        Damage: its arrays contradict each other.
    """
    arrays = _Arrays(mesh)
    if arrays.polygon_count:
        return arrays.polygons()
    return _old_faces(mesh, arrays) if _count(mesh, "totface") else None


def vertex(mesh: Record, index: int) -> tuple[float, float, float] | None:
    """The position of a vertex, or None if the mesh has no vertex of that number.

    Raises:
        Damage: the vertices are missing.
    """
    vertices = _Arrays(mesh).vertices()
    if not 0 <= index < len(vertices) or not (np.abs(vertices[index]) < 1e9).all():
        return None
    x, y, z = vertices[index].tolist()
    return x, y, z


def _count(mesh: Record, *fields: str) -> int:
    count = mesh.integer(mesh.either(*fields), 0)
    if count < 0:
        raise Damage("it has a negative number of elements")
    return count


def _old_faces(mesh: Record, arrays: _Arrays) -> Polygons | None:
    count, faces = _count(mesh, "totface"), mesh.target("mface")
    if faces is None:
        return None
    indices = np.stack([column(mesh, faces, "MFace", name, count) for name in ("v1", "v2", "v3", "v4")], axis=1)
    indices = indices.astype(np.int64)
    texture = shown(layers(mesh, "fdata"), kinds.MTFACE)
    uvs = pictures = None
    if texture is not None:
        uvs = column(mesh, texture.data, "MTFace", "uv", count).reshape(-1, 2).astype(np.float64)
        pictures = column(mesh, texture.data, "MTFace", "tpage", count).astype(np.uint64)
    return gather(
        arrays.vertices(),
        indices.ravel(),
        np.arange(count) * 4,
        # the fourth vertex is 0 for triangles; a quad never ends with vertex 0
        np.where(indices[:, 3] == 0, 3, 4),
        materials=column(mesh, faces, "MFace", "mat_nr", count).astype(np.int64),
        smooth=(column(mesh, faces, "MFace", "flag", count).astype(np.int64) & _SMOOTH).astype(np.bool_),
        uvs=uvs,
        pictures=pictures,
    )


class _Arrays:
    """Finds the arrays, whose location depends on the version of the file."""

    def __init__(self, mesh: Record) -> None:
        self.mesh = mesh
        self.vertex_count = _count(mesh, "totvert", "verts_num")
        self.corner_count = _count(mesh, "totloop", "corners_num")
        self.polygon_count = _count(mesh, "totpoly", "faces_num")
        self.edge_count = _count(mesh, "totedge", "edges_num")
        by_domain = attributes(mesh)
        self.vertex_layers = layers(mesh, "vdata", "vert_data") + by_domain[0]
        self.edge_layers = layers(mesh, "edata", "edge_data") + by_domain[1]
        self.polygon_layers = layers(mesh, "pdata", "face_data") + by_domain[2]
        self.corner_layers = layers(mesh, "ldata", "corner_data") + by_domain[3]

    def polygons(self) -> Polygons:
        starts, sizes = self._extents()
        texture = shown(self.polygon_layers, kinds.MTEXPOLY)
        pictures = None
        if texture is not None:
            pictures = column(self.mesh, texture.data, "MTexPoly", "tpage", self.polygon_count).astype(np.uint64)
        return gather(
            self.vertices(),
            self._corners(),
            starts,
            sizes,
            materials=self._materials(),
            smooth=self._smooth(),
            uvs=self._uvs(),
            sharp=self._sharp(),
            pictures=pictures,
        )

    def _structs(self, field: str, among: list[Layer], kind: int) -> Block | None:
        """An array of structs: by the field of the mesh, or by the type of its layer."""
        block = self.mesh.target(field) if self.mesh.has(field) else None
        if block is None:
            layer = shown(among, kind)
            block = None if layer is None else layer.data
        return block

    def vertices(self) -> Floats:
        block = self._structs("mvert", self.vertex_layers, kinds.MVERT)
        if block is not None:
            return column(self.mesh, block, "MVert", "co", self.vertex_count).reshape(-1, 3).astype(np.float64)
        layer = named(self.vertex_layers, "position", kinds.FLOAT3)
        if layer is None:
            raise Damage("its vertices are missing")
        return values(self.mesh, layer, self.vertex_count).astype(np.float64)

    def _corners(self) -> Ints:
        block = self._structs("mloop", self.corner_layers, kinds.MLOOP)
        if block is not None:
            return column(self.mesh, block, "MLoop", "v", self.corner_count).astype(np.int64)
        layer = named(self.corner_layers, ".corner_vert", kinds.INT32)
        if layer is None:
            raise Damage("the corners of its polygons are missing")
        return values(self.mesh, layer, self.corner_count).astype(np.int64)

    @cached_property
    def _polygon_structs(self) -> Block | None:
        return self._structs("mpoly", self.polygon_layers, kinds.MPOLY)

    def _polygon_field(self, *names: str) -> Ints | None:
        """Return a field of the polygons, for versions in which they are structs with that field."""
        block, index = self._polygon_structs, self.mesh.file.dna.index("MPoly")
        if block is None or index is None:
            return None
        fields = self.mesh.file.dna.struct(index).fields
        name = next((name for name in names if name in fields), None)
        return None if name is None else column(self.mesh, block, "MPoly", name, self.polygon_count).astype(np.int64)

    def _extents(self) -> tuple[Ints, Ints]:
        """(P,) first corner and number of corners of each polygon."""
        field = self.mesh.either("poly_offset_indices", "face_offset_indices")
        block = self.mesh.target(field) if self.mesh.has(field) else None
        if block is not None:
            offsets = plain(self.mesh, block, "i4", self.polygon_count + 1).astype(np.int64)
            return offsets[:-1], np.diff(offsets)
        starts, sizes = self._polygon_field("loopstart"), self._polygon_field("totloop")
        if starts is None or sizes is None:
            raise Damage("its polygons are missing")
        return starts, sizes

    def _materials(self) -> Ints | None:
        layer = named(self.polygon_layers, "material_index", kinds.INT32)
        if layer is not None:
            return values(self.mesh, layer, self.polygon_count).astype(np.int64)
        return self._polygon_field("mat_nr", "mat_nr_legacy")

    def _smooth(self) -> Bools:
        layer = named(self.polygon_layers, "sharp_face", kinds.BOOL)
        if layer is not None:
            return np.logical_not(values(self.mesh, layer, self.polygon_count).astype(np.bool_))
        flags = self._polygon_field("flag", "flag_legacy")
        if flags is None:
            # without an attribute, no edge is sharp
            return np.ones(self.polygon_count, np.bool_)
        return (flags & _SMOOTH).astype(np.bool_)

    def _sharp(self) -> Ints:
        """(E, 2) vertices of the edges that are marked sharp."""
        block = self._structs("medge", self.edge_layers, kinds.MEDGE)
        if block is not None:
            ends = np.stack(
                [column(self.mesh, block, "MEdge", name, self.edge_count).astype(np.int64) for name in ("v1", "v2")],
                axis=-1,
            )
            flags = column(self.mesh, block, "MEdge", "flag", self.edge_count).astype(np.int64) & _SHARP
        else:
            layer = named(self.edge_layers, ".edge_verts", kinds.INT32_2D)
            if layer is None:
                return np.zeros((0, 2), np.int64)
            ends = values(self.mesh, layer, self.edge_count).astype(np.int64)
            flags = np.zeros(self.edge_count, np.int64)
        sharp_edges = named(self.edge_layers, "sharp_edge", kinds.BOOL)
        if sharp_edges is not None:
            flags = flags | values(self.mesh, sharp_edges, self.edge_count).astype(np.int64)
        sharp_ends: Ints = ends[flags != 0]
        return sharp_ends

    def _uvs(self) -> Floats | None:
        layer = shown(self.corner_layers, kinds.MLOOPUV)
        if layer is not None:
            texture_coordinates = column(self.mesh, layer.data, "MLoopUV", "uv", self.corner_count)
            return texture_coordinates.reshape(-1, 2).astype(np.float64)
        layer = shown(self.corner_layers, kinds.FLOAT2)
        return None if layer is None else values(self.mesh, layer, self.corner_count).astype(np.float64)
