"""Determines what only Blender itself can evaluate: modifiers, curves, constraints, shape keys."""

from __future__ import annotations

from math import pi, radians
from typing import TYPE_CHECKING, NamedTuple

from morse.plugins.blend.bodies import group_properties
from morse.plugins.blend.poses import TRIANGLE, parent_kind

if TYPE_CHECKING:
    from collections.abc import Iterator

    from morse.plugins.blend.file import Record

MESH, CURVE, SURFACE, FONT, METABALL = 1, 2, 3, 4, 5
_SHOWN = 1
#: modifiers that do not move vertices: they change normals, mark vertices, or simulate
_HARMLESS = frozenset(
    f"{name}ModifierData"
    for name in (
        "Collision", "DataTransfer", "EdgeSplit", "NormalEdit", "ParticleSystem", "Softbody", "Surface", "Triangulate",
        "UVProject", "UVWarp", "WeightVGEdit", "WeightVGMix", "WeightVGProximity", "WeightedNormal",
    )
)  # fmt: skip
_SMOOTH_BY_ANGLE = "Smooth by Angle"
_FROM_ANGLE = 1 << 1
#: flags of constraints that are disabled or have no target
_MUTED_CONSTRAINT = 1 << 9 | 1 << 2
_MUTED_KEY = 1 << 0


class Needs(NamedTuple):
    """What Blender has to evaluate for an object."""

    mesh: bool
    pose: bool


def needs(record: Record) -> Needs:
    """Whether Blender has to evaluate something."""
    kind = record.integer("type")
    has_shape = kind in (SURFACE, FONT, METABALL) or (kind == CURVE and _has_surface(record))
    if kind == MESH:
        has_shape = any(_moves_vertices(modifier) for modifier in _modifiers(record)) or _is_keyed(record)
    has_constraint = any(
        not constraint.integer("flag", 0) & _MUTED_CONSTRAINT and constraint.real("enforce", 1.0) > 0.0
        for constraint in record.chain("constraints", "bConstraint")
    )
    return Needs(has_shape, has_constraint or parent_kind(record) == TRIANGLE)


def crease_angle(record: Record) -> float | None:
    """Return the angle above which edges are sharp, rad, if a modifier sets it."""
    for modifier in _modifiers(record):
        if modifier.struct.name == "EdgeSplitModifierData":
            if not modifier.integer("flags", 0) & _FROM_ANGLE:
                return pi
            angle = modifier.real("split_angle", pi)
            # the angle was stored in degrees until 2.6x; values in radians are at most pi
            return radians(angle) if angle > pi + 1e-3 else angle
        if _is_smooth_by_angle(modifier):
            settings = modifier.part("settings").follow("properties", "IDProperty")
            value = (group_properties(settings) if settings is not None else {}).get("Input_1")
            return float(value) if isinstance(value, (int, float)) and 0.0 <= value <= pi else radians(30)
    return None


def _modifiers(record: Record) -> Iterator[Record]:
    """Iterate over the enabled modifiers, each read as its struct type."""
    for modifier in record.chain("modifiers", "ModifierData"):
        if modifier.integer("mode", _SHOWN) & _SHOWN:
            yield record.file.record(modifier.block)


def _moves_vertices(modifier: Record) -> bool:
    return modifier.struct.name not in _HARMLESS and not _is_smooth_by_angle(modifier)


def _is_smooth_by_angle(modifier: Record) -> bool:
    if modifier.struct.name != "NodesModifierData":
        return False
    group = modifier.follow("node_group", "ID")
    return group is not None and group.text("name")[2:].startswith(_SMOOTH_BY_ANGLE)


def _is_keyed(record: Record) -> bool:
    """True if a shape key is in effect."""
    mesh = record.follow("data", "Mesh")
    key = None if mesh is None else mesh.follow("key", "Key")
    return key is not None and any(
        block.real("curval", 0.0) != 0.0 and not block.integer("flag", 0) & _MUTED_KEY
        for block in key.chain("block", "KeyBlock")
    )


def _has_surface(record: Record) -> bool:
    """Whether an object has a surface; false for curves that are only paths."""
    curve = record.follow("data", "Curve")
    if curve is None:
        return False
    flat = not curve.integer("flag", 1) & 1
    return flat or curve.real("ext1") != 0.0 or curve.real("ext2") != 0.0 or bool(curve.integer("bevobj", 0))
