"""Merges the values of a changed model file with changes that a script has made."""

from __future__ import annotations

from dataclasses import fields, is_dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from morse.mathutils import Matrix

if TYPE_CHECKING:
    from morse.scene import Material, Node

#: fields of a node that depend on its parent in the scene, or are derived from other fields
_APART = ("name", "parent", "children", "source_name", "location", "materials", "shapes")


def same(one: Any, other: Any) -> bool:
    """Whether two values have the same content."""
    if one is other:
        return True
    if type(one) is not type(other):
        return False
    if isinstance(one, np.ndarray):
        return one.dtype == other.dtype and np.array_equal(one, other, equal_nan=one.dtype.kind == "f")
    if isinstance(one, Matrix):
        return [list(row) for row in one] == [list(row) for row in other]
    if is_dataclass(one):
        return all(same(getattr(one, part.name), getattr(other, part.name)) for part in fields(one))
    if isinstance(one, (list, tuple)):
        return len(one) == len(other) and all(map(same, one, other))
    if isinstance(one, dict):
        return one.keys() == other.keys() and all(same(value, other[key]) for key, value in one.items())
    return bool(one == other)


def merged(before: Any, now: Any, after: Any) -> Any:
    """Return the present value in the file, except for changes by a script.

    Args:
        before: value in the file when it was loaded.
        now: value in the scene.
        after: present value in the file.
    """
    if same(before, after) or same(now, after):
        return now
    if same(before, now):
        return after
    kinds = {type(value) for value in (before, now, after)}
    if len(kinds) != 1:
        return now
    if is_dataclass(now) and not isinstance(now, type):
        changes = {}
        for name in [part.name for part in fields(now)]:
            changes[name] = merged(*(getattr(value, name) for value in (before, now, after)))
        return replace(now, **changes)
    if isinstance(now, dict):
        return _merged_dict(before, now, after)
    if isinstance(now, (list, tuple)) and len(before) == len(now) == len(after):
        return type(now)(map(merged, before, now, after))
    return now


def _merged_dict(
    before: dict[object, object], now: dict[object, object], after: dict[object, object]
) -> dict[object, object]:
    result = {}
    for key in [*now, *(key for key in after if key not in now)]:
        if key in now and key in before and key not in after and same(before[key], now[key]):
            continue  # the key is no longer in the file
        if key in now:
            result[key] = merged(before.get(key), now[key], after[key]) if key in after else now[key]
        elif key not in before:
            result[key] = after[key]  # keys that a script has removed stay removed
    return result


def merge_node(before: Node, now: Node, after: Node, *, is_root: bool) -> None:
    """Merge the changes of a script into a node of the changed file.

    An offset that a script has added to the pose of a part is kept.

    Args:
        before: the node in the old file.
        now: the node of the scene.
        after: the node in the changed file; it is modified.
        is_root: whether the script determines its pose.
    """
    for part in fields(after):
        if part.name not in _APART:
            setattr(after, part.name, merged(*(getattr(node, part.name) for node in (before, now, after))))
    if is_root:
        after.location = merged(before.location, now.location, after.location)
    else:
        places = zip(before.location, now.location, after.location, strict=True)
        after.location = [b if a == c else c + (b - a) for a, b, c in places]
    after.materials = _materials(before, now, after)
    after.name = now.name


def _materials(before: Node, now: Node, after: Node) -> list[Material | None]:
    if same(before.materials, now.materials):
        return now.materials if same(before.materials, after.materials) else after.materials
    paint, original, latest = _slots(now), _slots(before), _slots(after)
    if len(paint) == len(original) == len(latest):
        return list(map(merged, original, paint, latest))
    return now.materials


def _slots(node: Node) -> list[Material | None]:
    """Return the materials of a node: its own, or else those of its mesh."""
    defaults = list(node.mesh.materials) if node.mesh is not None else []
    slots = [*node.materials, *defaults[len(node.materials) :]]
    return [own if own is not None else defaults[i] if i < len(defaults) else None for i, own in enumerate(slots)]
