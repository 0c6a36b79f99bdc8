"""Where a mesh keeps its arrays: in fields of its own, in custom data layers, or in attributes."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from morse.assets.blend.errors import Damage

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from morse.assets.blend.blocks import Block
    from morse.assets.blend.file import Record

#: types of layers
MTFACE, MTEXPOLY, MLOOPUV, FLOAT2 = 5, 15, 16, 49
_MAX_LAYERS = 10_000


class Layer(NamedTuple):
    """A named array.

    Attributes:
        type: one of Blender's numbers for the type of its items.
        data: the block that holds the items.
        render: it is the one to show among those of its type.
    """

    type: int
    name: str
    data: Block
    render: bool


def layers(mesh: Record, *fields: str) -> list[Layer]:
    """The custom data layers in the first of these fields that the mesh has."""
    field = mesh.either(*fields)
    if not mesh.has(field):
        return []
    holder = mesh.part(field)
    found: list[Layer] = []
    seen: dict[int, int] = {}
    for record in holder.items("layers", "CustomDataLayer", min(holder.integer("totlayer"), _MAX_LAYERS)):
        kind = record.integer("type")
        rank = seen[kind] = seen.get(kind, -1) + 1
        data = record.target("data")
        if data is not None:
            found.append(Layer(kind, record.text("name"), data, rank == record.integer("active_rnd", 0)))
    return found


def attributes(mesh: Record) -> dict[str, Layer]:
    """The attributes of files since 5.0, by name."""
    if not mesh.has("attribute_storage"):
        return {}
    storage = mesh.part("attribute_storage")
    found: dict[str, Layer] = {}
    count = min(storage.integer("dna_attributes_num", 0), _MAX_LAYERS)
    for record in storage.items("dna_attributes", "Attribute", count):
        array = record.follow("data")
        if array is None or array.struct.name != "AttributeArray":
            continue
        data = array.target("data")
        if data is not None:
            name = record.content("name").split(b"\0", 1)[0].decode("utf-8", "replace")
            found[name] = Layer(record.integer("data_type"), name, data, True)
    return found


def column(mesh: Record, block: Block, struct: str, field: str, count: int) -> NDArray[np.generic]:
    """One field of an array of structs.

    Raises:
        Damage: the block is shorter than `count` structs, or the file knows no such struct.
    """
    index = mesh.file.dna.index(struct)
    if index is None:
        raise Damage(f"it uses the struct {struct}, which is not described")
    if not count:
        return np.zeros(0)
    return mesh.file.record(block, index).column(block, field, count)


def plain(mesh: Record, block: Block, kind: str, count: int, width: int = 1) -> NDArray[np.generic]:
    """An array of plain numbers: (count,), or (count, width).

    Raises:
        Damage: the block is shorter.
    """
    numpy = np.dtype(mesh.file.endian + kind)
    if count * width * numpy.itemsize > block.size:
        raise Damage("an array of it is shorter than it says")
    values = np.frombuffer(mesh.file.data, numpy, count * width, block.offset)
    return values if width == 1 else values.reshape(count, width)
