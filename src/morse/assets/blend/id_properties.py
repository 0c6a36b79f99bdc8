"""Custom (id) properties of datablocks."""

from __future__ import annotations

import struct
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from morse.assets.blend.record import Record

_STRING, _INT, _FLOAT, _ARRAY, _GROUP, _ID, _DOUBLE, _GROUP_ARRAY, _BOOLEAN = 0, 1, 2, 5, 6, 7, 8, 9, 10
_ITEMS = {_INT: "i4", _FLOAT: "f4", _DOUBLE: "f8", _BOOLEAN: "i1"}
_DEPTH = 8
_MAX_ITEMS = 1 << 20
#: settings of Blender and its renderers that are stored like custom properties
_PRIVATE = ("_RNA_UI", "cycles", "cycles_visibility", "cycles_curves", "rigify_", "bl_")


def id_properties(record: Record) -> dict[str, object]:
    """The custom properties of a datablock: bool, int, float, str, lists of these, and groups as dicts."""
    holder = record.part("id")
    if not holder.integer("properties", 0):
        return {}
    group = holder.follow("properties", "IDProperty")
    return {} if group is None else group_properties(group)


def group_properties(group: Record, depth: int = 0) -> dict[str, object]:
    """The properties in a group."""
    properties: dict[str, object] = {}
    if depth > _DEPTH:
        return properties
    for entry in group.part("data").chain("group", "IDProperty"):
        name = entry.text("name")
        if not name or name.startswith(_PRIVATE):
            continue
        value = _value(entry, depth)
        if value is not None:
            properties[name] = value
    return properties


def _value(entry: Record, depth: int) -> object:
    kind, data = entry.integer("type"), entry.part("data")
    if kind == _STRING:
        return data.string("pointer")
    if kind == _INT:
        return data.integer("val")
    if kind == _BOOLEAN:
        return data.integer("val") != 0
    if kind == _FLOAT:
        return _finite(struct.unpack("=f", struct.pack("=i", data.integer("val")))[0])
    if kind == _DOUBLE:
        low, high = data.integer("val"), data.integer("val2")
        if data.file.endian == ">":
            low, high = high, low
        return _finite(struct.unpack("<d", struct.pack("<ii", low, high))[0])
    if kind == _GROUP:
        return group_properties(entry, depth + 1)
    if kind == _ARRAY:
        return _array(entry, data, depth)
    if kind == _ID:
        return _pointed_name(data)
    if kind == _GROUP_ARRAY:
        return [group_properties(item, depth + 1) for item in data.items("pointer", "IDProperty", _length(entry))]
    return None


def _array(entry: Record, data: Record, depth: int) -> object:
    kind, block = entry.integer("subtype"), data.target("pointer")
    if block is None:
        return []
    if kind == _GROUP:
        addresses = data.addresses("pointer", _length(entry))
        groups = (data.at(address, "IDProperty") for address in addresses)
        return [group_properties(group, depth + 1) for group in groups if group is not None]
    numpy = _ITEMS.get(kind)
    if numpy is None:
        return None
    item = np.dtype(data.file.endian + numpy)
    count = min(_length(entry), block.size // item.itemsize)
    data.file.spend(1 + count // 4)
    values = np.frombuffer(data.file.data, item, count, block.offset)
    if kind == _BOOLEAN:
        return (values != 0).tolist()
    return np.nan_to_num(values, posinf=0.0, neginf=0.0).tolist() if item.kind == "f" else values.tolist()


def _length(entry: Record) -> int:
    return min(max(entry.integer("len", 0), 0), _MAX_ITEMS)


def _pointed_name(data: Record) -> str | None:
    """Return the name of a datablock to which a property points."""
    target = data.follow("pointer", "ID")
    return None if target is None else target.text("name")[2:]


def _finite(value: float) -> float:
    return value if abs(value) < float("inf") else 0.0
