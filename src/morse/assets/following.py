"""Determines which nodes of a scene are replaced, added and removed when a model file has changed."""

from __future__ import annotations

from contextlib import contextmanager
from dataclasses import dataclass, field, fields, replace
from typing import TYPE_CHECKING

from morse.assets.collision import resolve_shapes
from morse.assets.merging import merge_node, same
from morse.scene import Scene
from morse.scene.frames import rigid_frame

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from morse.scene import ModelUse, Node

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
