"""Meshes: their arrays in all versions of the format, and the layers of attributes."""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property
from math import pi, radians
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from morse.assets.polygons import Bools, Floats, Ints, Polygons, corner_normals
from morse.plugins.blend.container import Damage
from morse.plugins.blend.file import datablock_name
from morse.plugins.blend.polygons import gather, triangulate
from morse.scene import Material, Mesh

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from morse.assets.polygons import Floats, Polygons
    from morse.plugins.blend.container import Block
    from morse.plugins.blend.file import Record
    from morse.plugins.blend.materials import Materials

#: types of layers
MVERT, MEDGE, MTFACE, INT32, MTEXPOLY, MLOOPUV, MPOLY, MLOOP, FLOAT3, FLOAT2, BOOL, INT32_2D = (
    0, 3, 5, 11, 15, 16, 25, 26, 48, 49, 50, 46,
)  # fmt: skip
#: type of attribute to the corresponding type of layer
_ATTRIBUTE_TYPES = {0: BOOL, 3: INT32, 4: INT32_2D, 6: FLOAT2, 7: FLOAT3}
_NUMPY = {BOOL: ("u1", 1), INT32: ("i4", 1), FLOAT3: ("f4", 3), FLOAT2: ("f4", 2), INT32_2D: ("i4", 2)}
_MAX_LAYERS = 10_000


class Layer(NamedTuple):
    """A named array.

    Attributes:
        type: Blender's number for the type of its items.
        data: the block that contains the items.
        render: whether it is the layer to show among those of its type.
        single: whether one item applies to all elements.
    """

    type: int
    name: str
    data: Block
    render: bool = False
    single: bool = False


def layers(mesh: Record, *fields: str) -> list[Layer]:
    """The custom data layers in the first of these fields that the mesh has."""
    field = mesh.either(*fields)
    if not mesh.has(field):
        return []
    holder = mesh.part(field)
    layer_list: list[Layer] = []
    counts_by_type: dict[int, int] = {}
    for record in holder.items("layers", "CustomDataLayer", min(holder.integer("totlayer"), _MAX_LAYERS)):
        kind = record.integer("type")
        rank = counts_by_type[kind] = counts_by_type.get(kind, -1) + 1
        data = record.target("data")
        if data is not None:
            layer_list.append(Layer(kind, record.text("name"), data, rank == record.integer("active_rnd", 0)))
    return layer_list


def attributes(mesh: Record) -> dict[int, list[Layer]]:
    """The attributes of files since 5.0, by domain: 0 vertices, 1 edges, 2 polygons, 3 corners."""
    by_domain: dict[int, list[Layer]] = {0: [], 1: [], 2: [], 3: []}
    if not mesh.has("attribute_storage"):
        return by_domain
    storage = mesh.part("attribute_storage")
    shown_name = mesh.string("default_uv_map_attribute")
    count = min(storage.integer("dna_attributes_num", 0), _MAX_LAYERS)
    for record in storage.items("dna_attributes", "Attribute", count):
        kind = _ATTRIBUTE_TYPES.get(record.integer("data_type"))
        holder = record.follow("data")
        data = None if holder is None or not holder.has("data") else holder.target("data")
        if kind is None or holder is None or data is None:
            continue
        name = record.string("name")
        single = holder.struct.name == "AttributeSingle" or bool(holder.integer("is_single", 0))
        by_domain.get(record.integer("domain"), []).append(Layer(kind, name, data, name == shown_name, single))
    return by_domain


def named(among: list[Layer], name: str, kind: int) -> Layer | None:
    """The layer of that name and type."""
    return next((layer for layer in among if layer.name == name and layer.type == kind), None)


def shown(among: list[Layer], kind: int) -> Layer | None:
    """Return the layer of that type that is marked for rendering, or else the first."""
    candidates = [layer for layer in among if layer.type == kind]
    return next((layer for layer in candidates if layer.render), candidates[0] if candidates else None)


def column(mesh: Record, block: Block, struct: str, field: str, count: int) -> NDArray[np.generic]:
    """One field of an array of structs.

    Raises:
        Damage: the block is shorter than `count` structs, or the file does not describe the struct.
    """
    index = mesh.file.dna.index(struct)
    if index is None:
        raise Damage(f"it uses the struct {struct}, which is not described")
    return mesh.file.column(block, mesh.file.dna.struct(index), field, count)


def values(mesh: Record, layer: Layer, count: int) -> NDArray[np.generic]:
    """The items of a layer of plain numbers: (count,), or (count, width).

    Raises:
        Damage: the block is shorter.
    """
    kind, width = _NUMPY[layer.type]
    array = plain(mesh, layer.data, kind, 1 if layer.single else count, width)
    return np.repeat(array, count, axis=0) if layer.single else array


def plain(mesh: Record, block: Block, kind: str, count: int, width: int = 1) -> NDArray[np.generic]:
    """An array of plain numbers: (count,), or (count, width).

    Raises:
        Damage: the block is shorter.
    """
    numpy = np.dtype(mesh.file.endian + kind)
    if count * width * numpy.itemsize > block.size:
        raise Damage("one of its arrays is shorter than its declared length")
    raw = np.frombuffer(mesh.file.data, numpy, count * width, block.offset)
    return raw if width == 1 else raw.reshape(count, width)


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
    texture = shown(layers(mesh, "fdata"), MTFACE)
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
        texture = shown(self.polygon_layers, MTEXPOLY)
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
        block = self._structs("mvert", self.vertex_layers, MVERT)
        if block is not None:
            return column(self.mesh, block, "MVert", "co", self.vertex_count).reshape(-1, 3).astype(np.float64)
        layer = named(self.vertex_layers, "position", FLOAT3)
        if layer is None:
            raise Damage("its vertices are missing")
        return values(self.mesh, layer, self.vertex_count).astype(np.float64)

    def _corners(self) -> Ints:
        block = self._structs("mloop", self.corner_layers, MLOOP)
        if block is not None:
            return column(self.mesh, block, "MLoop", "v", self.corner_count).astype(np.int64)
        layer = named(self.corner_layers, ".corner_vert", INT32)
        if layer is None:
            raise Damage("the corners of its polygons are missing")
        return values(self.mesh, layer, self.corner_count).astype(np.int64)

    @cached_property
    def _polygon_structs(self) -> Block | None:
        return self._structs("mpoly", self.polygon_layers, MPOLY)

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
        layer = named(self.polygon_layers, "material_index", INT32)
        if layer is not None:
            return values(self.mesh, layer, self.polygon_count).astype(np.int64)
        return self._polygon_field("mat_nr", "mat_nr_legacy")

    def _smooth(self) -> Bools:
        layer = named(self.polygon_layers, "sharp_face", BOOL)
        if layer is not None:
            return np.logical_not(values(self.mesh, layer, self.polygon_count).astype(np.bool_))
        flags = self._polygon_field("flag", "flag_legacy")
        if flags is None:
            # without an attribute, no edge is sharp
            return np.ones(self.polygon_count, np.bool_)
        return (flags & _SMOOTH).astype(np.bool_)

    def _sharp(self) -> Ints:
        """(E, 2) vertices of the edges that are marked sharp."""
        block = self._structs("medge", self.edge_layers, MEDGE)
        if block is not None:
            ends = np.stack(
                [column(self.mesh, block, "MEdge", name, self.edge_count).astype(np.int64) for name in ("v1", "v2")],
                axis=-1,
            )
            flags = column(self.mesh, block, "MEdge", "flag", self.edge_count).astype(np.int64) & _SHARP
        else:
            layer = named(self.edge_layers, ".edge_verts", INT32_2D)
            if layer is None:
                return np.zeros((0, 2), np.int64)
            ends = values(self.mesh, layer, self.edge_count).astype(np.int64)
            flags = np.zeros(self.edge_count, np.int64)
        sharp_edges = named(self.edge_layers, "sharp_edge", BOOL)
        if sharp_edges is not None:
            flags = flags | values(self.mesh, sharp_edges, self.edge_count).astype(np.int64)
        sharp_ends: Ints = ends[flags != 0]
        return sharp_ends

    def _uvs(self) -> Floats | None:
        layer = shown(self.corner_layers, MLOOPUV)
        if layer is not None:
            texture_coordinates = column(self.mesh, layer.data, "MLoopUV", "uv", self.corner_count)
            return texture_coordinates.reshape(-1, 2).astype(np.float64)
        layer = shown(self.corner_layers, FLOAT2)
        return None if layer is None else values(self.mesh, layer, self.corner_count).astype(np.float64)


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
