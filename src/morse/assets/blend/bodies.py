"""Physics settings in files: rigid bodies of Blender 2.66 and later, and settings of the old game engine.

Both are dictionaries of fields of `BodySettings`; `morse.assets.rules` combines them.
"""

from __future__ import annotations

import struct
from typing import TYPE_CHECKING

from morse.scene import Bounds, PhysicsType

if TYPE_CHECKING:
    from morse.assets.blend.record import Record

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
_BOOL, _INT, _FLOAT, _STRING, _TIMER = 0, 1, 2, 3, 5
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
        if kind == _BOOL:
            properties[name] = data != 0
        elif kind == _INT:
            properties[name] = data
        elif kind in (_FLOAT, _TIMER):
            value: float = struct.unpack("=f", struct.pack("=i", data))[0]
            properties[name] = value if abs(value) < float("inf") else 0.0
        elif kind == _STRING:
            properties[name] = entry.string("poin")
    return properties


def debug_properties(record: Record) -> tuple[str, ...]:
    """Return the game properties that are marked for display while the game runs."""
    return tuple(entry.text("name") for entry in record.chain("prop", "bProperty") if entry.integer("flag", 0) & _SHOWN)
