"""Follows a model file that has changed: nodes that are replaced, added and removed, and values of the script."""

from __future__ import annotations

from contextlib import contextmanager
from dataclasses import dataclass, field, fields, is_dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from morse.assets.collision import resolve_shapes
from morse.mathutils import Matrix
from morse.scene import Scene
from morse.scene.frames import rigid_frame

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from morse.scene import Material, ModelUse, Node


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


#: fields that are not compared: those of the tree, and those derived from other fields
_NOT_COMPARED = ("parent", "children", "source_name", "shapes")
#: tolerance for equal stretches
_ROUNDING = 1e-9


@dataclass
class Revision:
    """The changes of a scene by a changed file, before they are applied.

    Attributes:
        use: the record of the nodes after the change.
        replaced: pairs of old and new trees of the scene.
        moved: pairs of nodes that the file does not contain, and their new parents.
        come: new trees without a parent.
        gone: trees of the scene that are no longer in the file.
        warnings: warnings for the user.
    """

    use: ModelUse
    replaced: list[tuple[Node, Node]] = field(default_factory=list)
    moved: list[tuple[Node, Node]] = field(default_factory=list)
    come: list[Node] = field(default_factory=list)
    gone: list[Node] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)


def follow(scene: Scene, use: ModelUse, roots: Sequence[Node], latest: ModelUse) -> Revision:
    """Compute the changes of the nodes of a changed file.

    Values that a script has set are kept: poses, materials, physics, properties. Nodes attached to the nodes are kept
    as well.

    Args:
        use: the record of the nodes in the scene.
        roots: the present nodes of the file; they become part of the result.
        latest: the record of the present nodes.
    """
    return _Following(scene, use, roots, latest).follow()


def resolve(revisions: Sequence[Revision]) -> list[str]:
    """Compute the collision shapes of the new nodes.

    Returns:
        Warnings for the user.
    """
    pairs = [pair for revision in revisions for pair in revision.replaced]
    come = [root for revision in revisions for root in revision.come]
    with _hanging(pairs):
        return resolve_shapes(Scene(roots=[*(after for _, after in pairs), *come]))


@contextmanager
def _hanging(pairs: Sequence[tuple[Node, Node]]) -> Iterator[None]:
    """Attach new trees to their future parents inside the block, because the scale of a parent affects the shapes."""
    for now, after in pairs:
        after.parent = now.parent
    try:
        yield
    finally:
        for _, after in pairs:
            after.parent = None


class _Following:
    def __init__(self, scene: Scene, use: ModelUse, roots: Sequence[Node], latest: ModelUse) -> None:
        self._roots = roots
        self._present = {node.name: node for node in scene.nodes()}
        self._use = use if use.choice.role == "environment" else _with_root(use, [root.name for root in roots])
        #: the nodes of the scene, and the present nodes of the file, by name in the file
        self._now = {name: node for name, node in self._use.nodes.items() if self._present.get(node.name) is node}
        self._after = latest.nodes
        self._own = {id(node) for node in self._now.values()}
        self._revision = Revision(latest)

    def follow(self) -> Revision:
        units = [root.name for root in self._roots if root.name in self._now] + self._taken_elsewhere()
        self._revision.come = [root for root in self._roots if root.name not in self._use.originals]
        for name, after in self._after.items():
            if name in self._now:
                merge_node(self._use.originals[name], self._now[name], after, is_root=after.parent is None)
        self._leave_out_deleted()
        self._name_newcomers()
        trees = [(self._now[name], self._after[name]) for name in units]
        for now, after in trees:
            self._replace(now, after)
        self._go()
        self._keep_shapes()
        self._remember_the_first()
        return self._revision

    def _taken_elsewhere(self) -> list[str]:
        """Return nodes whose parent was changed by a script; they keep that parent."""
        names = []
        for name, after in self._after.items():
            now = self._now.get(name)
            if now is None or after.parent is None:
                continue
            before = self._use.originals[name].parent
            if now.parent is not (None if before is None else self._use.nodes[before.name]):
                after.detach()
                after.parent_inverse = now.parent_inverse
                names.append(name)
        return names

    def _leave_out_deleted(self) -> None:
        """Remove nodes that a script has deleted."""
        for name in [name for name in self._after if name in self._use.originals and name not in self._now]:
            self._after.pop(name).detach()

    def _name_newcomers(self) -> None:
        taken_names = set(self._present)
        for name, after in self._after.items():
            if name not in self._now:
                count = 0
                while after.name in taken_names:
                    count += 1
                    after.name = f"{name}.{count:03d}"
                taken_names.add(after.name)

    def _replace(self, now: Node, after: Node) -> None:
        """Replace a tree of the scene, unless it is unchanged."""
        within = {id(node) for node in after.walk()}
        new = {id(mine): self._after[name] for name, mine in self._now.items() if name in self._after}
        going, moved_nodes, stack = set(), [], [now]
        while stack:
            node = stack.pop()
            going.add(id(node))
            for child in node.children:
                # remove nodes that the file no longer has; replace nodes of the new tree together with their parent
                if id(child) in self._own and id(new.get(id(child), after)) in within:
                    stack.append(child)
                else:
                    place = next(new[id(above)] for above in (node, *node.ancestors()) if id(above) in new)
                    moved_nodes.append((child, place))
        if _same_tree(now, after, {id(child) for child, _ in moved_nodes}):
            for name, mine in self._now.items():
                if id(mine) in going:
                    self._after[name] = mine
            return
        self._revision.replaced.append((now, after))
        self._revision.moved += moved_nodes

    def _go(self) -> None:
        """Remove nodes that are no longer in the file and do not belong to a replaced tree."""
        numbers = {id(node) for now, _ in self._revision.replaced for node in now.walk()}
        for name, node in self._now.items():
            if name in self._after or id(node) in numbers:
                continue
            strangers = [below.name for below in node.walk() if id(below) not in self._own]
            if strangers:
                self._revision.warnings.append(
                    f"'{node.name}' is no longer in the file; it is kept, because '{strangers[0]}' is attached to it"
                )
                continue
            numbers.update(id(below) for below in node.walk())
            self._revision.gone.append(node)

    def _remember_the_first(self) -> None:
        """Keep the first object, which the script refers to, independent of its position in the file."""
        first, originals = next(iter(self._use.originals)), self._revision.use.originals
        if first in originals:
            self._revision.use.originals = {first: originals[first], **originals}

    def _keep_shapes(self) -> None:
        with _hanging(self._revision.replaced):
            for name, now in self._now.items():
                after = self._after.get(name, now)
                if after is not now and _shaped_alike(now, after):
                    after.shapes = now.shapes


def _with_root(use: ModelUse, roots: Sequence[str]) -> ModelUse:
    """Return the record, with the name of the first object of a component changed to its present name in the file.

    The object may have been renamed, or another object may have become the root.
    """
    before, name = next(iter(use.originals)), roots[0]
    if before in roots or (name in use.originals and not use.choice.whole):
        name = before
    names = {} if before == name else {before: name, name: before}
    for node_copy, original in use.originals.items():
        original.name = names.get(node_copy, node_copy)
    if not names:
        return use
    nodes = {names.get(node_copy, node_copy): node for node_copy, node in use.nodes.items()}
    return replace(use, nodes=nodes, originals={original.name: original for original in use.originals.values()})


def _shaped_alike(now: Node, after: Node) -> bool:
    """Whether the shapes of a node, whose computation takes time, can be used for the other node."""
    if after.shapes is not None or after.mesh is None or after.mesh is not now.mesh or not same(now.body, after.body):
        return False
    one, other = rigid_frame(now).stretch, rigid_frame(after).stretch
    return all(abs(one[i][j] - other[i][j]) < _ROUNDING for i in range(3) for j in range(3))


def _same_tree(now: Node, after: Node, foreign: set[int]) -> bool:
    names = [part.name for part in fields(now) if part.name not in _NOT_COMPARED]
    if not all(same(getattr(now, name), getattr(after, name)) for name in names):
        return False
    children = [child for child in now.children if id(child) not in foreign]
    return len(children) == len(after.children) and all(
        _same_tree(one, other, foreign) for one, other in zip(children, after.children, strict=True)
    )
