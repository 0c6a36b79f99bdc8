"""Physics and properties of objects."""

from __future__ import annotations

import struct
from typing import TYPE_CHECKING

import numpy as np

from morse.scene import Bounds, PhysicsType

if TYPE_CHECKING:
    from morse.plugins.blend.file import Record

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


# rigid bodies
_PASSIVE = 1
_KINEMATIC, _DISABLED = 1 << 0, 1 << 5
_COMPOUND = 7
_SHAPES = {
    0: Bounds.BOX, 1: Bounds.SPHERE, 2: Bounds.CAPSULE, 3: Bounds.CYLINDER, 4: Bounds.CONE,
    5: Bounds.CONVEX_HULL, 6: Bounds.TRIANGLE_MESH,
}  # fmt: skip

# game engine: bits of `gameflag` and `gameflag2`
_DYNAMIC, _CHILD, _ACTOR, _GHOST, _RIGID_BODY, _BOUNDS = 1 << 0, 1 << 1, 1 << 2, 1 << 9, 1 << 10, 1 << 11
_COLLISION, _SOFT_BODY, _OCCLUDER, _SENSOR, _NAVMESH, _CHARACTER = (1 << bit for bit in (16, 17, 18, 19, 20, 22))
_LOCK_LOCATION = (1 << 2, 1 << 3, 1 << 4)
_LOCK_ROTATION = (1 << 5, 1 << 6, 1 << 7)
_GAME_BOUNDS = {
    0: Bounds.BOX, 1: Bounds.SPHERE, 2: Bounds.CYLINDER, 3: Bounds.CONE, 4: Bounds.TRIANGLE_MESH,
    5: Bounds.CONVEX_HULL, 7: Bounds.CAPSULE,
}  # fmt: skip
_GAME_BOOL, _GAME_INT, _GAME_FLOAT, _GAME_STRING, _GAME_TIMER = 0, 1, 2, 3, 5
_SHOWN = 1 << 0


def rigid_body(record: Record) -> dict[str, object]:
    """The rigid body settings of an object; empty if it has none."""
    settings = record.follow("rigidbody_object", "RigidBodyOb") if record.integer("rigidbody_object", 0) else None
    if settings is None:
        return {}
    flag, shape = settings.integer("flag"), settings.integer("shape")
    still = settings.integer("type") == _PASSIVE or flag & (_KINEMATIC | _DISABLED)
    return {
        "type": PhysicsType.STATIC if still else PhysicsType.RIGID_BODY,
        "bounds": _SHAPES.get(shape),
        "compound": shape == _COMPOUND,
        "mass": settings.real("mass", 1.0),
        "friction": settings.real("friction", 0.5),
        "restitution": settings.real("restitution", 0.0) or None,
        "linear_damping": settings.real("lin_damping", 0.04),
        "angular_damping": settings.real("ang_damping", 0.1),
    }


def game_settings(record: Record) -> dict[str, object]:
    """The settings for the game engine (until 2.79); empty for files without them."""
    if not record.has("gameflag"):
        return {}
    flag, locks = record.integer("gameflag"), record.integer("gameflag2", 0)
    bounds = record.integer(record.either("collision_boundtype", "boundtype"), 0)
    return {
        "type": game_physics_type(flag),
        "bounds": _GAME_BOUNDS.get(bounds) if flag & _BOUNDS else None,
        "compound": bool(flag & _CHILD),
        "mass": record.real("mass", 1.0),
        "radius": record.real("inertia", 1.0),
        "linear_damping": record.real("damping", 0.04),
        "angular_damping": record.real("rdamping", 0.1),
        "ghost": bool(flag & _GHOST),
        "actor": bool(flag & _ACTOR),
        "lock_location": tuple(bool(locks & bit) for bit in _LOCK_LOCATION),
        "lock_rotation": tuple(bool(locks & bit) for bit in _LOCK_ROTATION),
    }


def game_physics_type(flag: int) -> PhysicsType:
    """Return the physics type for a `gameflag`."""
    if not flag & _COLLISION:
        return PhysicsType.OCCLUDER if flag & _OCCLUDER else PhysicsType.NO_COLLISION
    if flag & _CHARACTER:
        return PhysicsType.CHARACTER
    if flag & _SENSOR:
        return PhysicsType.SENSOR
    if flag & _NAVMESH:
        return PhysicsType.NAVMESH
    if not flag & _DYNAMIC:
        return PhysicsType.STATIC
    if flag & _RIGID_BODY:
        return PhysicsType.RIGID_BODY
    return PhysicsType.SOFT_BODY if flag & _SOFT_BODY else PhysicsType.DYNAMIC


def game_properties(record: Record) -> dict[str, object]:
    """The game properties of an object (until 2.79)."""
    properties: dict[str, object] = {}
    for entry in record.chain("prop", "bProperty"):
        kind, data = entry.integer("type"), entry.integer("data", 0)
        name = entry.text("name")
        if kind == _GAME_BOOL:
            properties[name] = data != 0
        elif kind == _GAME_INT:
            properties[name] = data
        elif kind in (_GAME_FLOAT, _GAME_TIMER):
            value: float = struct.unpack("=f", struct.pack("=i", data))[0]
            properties[name] = value if abs(value) < float("inf") else 0.0
        elif kind == _GAME_STRING:
            properties[name] = entry.string("poin")
    return properties


def debug_properties(record: Record) -> tuple[str, ...]:
    """Return the game properties that are marked for display while the game runs."""
    return tuple(entry.text("name") for entry in record.chain("prop", "bProperty") if entry.integer("flag", 0) & _SHOWN)
