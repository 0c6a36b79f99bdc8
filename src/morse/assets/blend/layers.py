"""The named arrays of a mesh: custom data layers until 4.5, attributes since 5.0."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from morse.assets.blend.errors import Damage

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from morse.assets.blend.blocks import Block
    from morse.assets.blend.record import Record

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
