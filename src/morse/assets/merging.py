"""A model file has changed: what becomes of a value that the file gave and a script may have changed."""

from __future__ import annotations

from dataclasses import fields, is_dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from morse.mathutils import Matrix

if TYPE_CHECKING:
    from morse.scene import Material, Node

#: fields of a node that its place in the scene decides, or that follow from others
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
    """What the file says now, except for what a script has changed.

    Args:
        before: what the file said when it was loaded.
        now: what the scene has.
        after: what the file says now.
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


def _merged_dict(before: dict[Any, Any], now: dict[Any, Any], after: dict[Any, Any]) -> dict[Any, Any]:
    result = {}
    for key in [*now, *(key for key in after if key not in now)]:
        if key in now and key in before and key not in after and same(before[key], now[key]):
            continue  # the file does not say it any more
        if key in now:
            result[key] = merged(before.get(key), now[key], after[key]) if key in after else now[key]
        elif key not in before:
            result[key] = after[key]  # what a script has taken away stays away
    return result


def merge_node(before: Node, now: Node, after: Node, *, is_root: bool) -> None:
    """Make the node of the file that has changed the one that comes into the scene.

    A part that a script has shifted stays shifted by as much.

    Args:
        before: the node as the file had it.
        now: the node of the scene.
        after: the node as the file has it now; it is changed.
        is_root: whether the script decides where it is.
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
    painted, original, latest = _slots(now), _slots(before), _slots(after)
    if len(painted) == len(original) == len(latest):
        return list(map(merged, original, painted, latest))
    return now.materials


def _slots(node: Node) -> list[Material | None]:
    """What a node shows: its own materials, else those of its mesh."""
    defaults = list(node.mesh.materials) if node.mesh is not None else []
    slots = [*node.materials, *defaults[len(node.materials) :]]
    return [own if own is not None else defaults[i] if i < len(defaults) else None for i, own in enumerate(slots)]
