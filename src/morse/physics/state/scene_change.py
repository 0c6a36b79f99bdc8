"""Adds nodes to a running scene or removes nodes from it, with undo."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeVar

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

    from morse.scene import ComponentDeclaration, Node, Scene, Zone

_T = TypeVar("_T")


class SceneChange:
    """A change of the nodes and declarations of a scene.

    Attributes:
        scene: the scene.
    """

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self._undo: list[Callable[[], None]] = []
        self._parents: list[tuple[Node, Node | None]] = []
        self._declared: list[tuple[ComponentDeclaration, Node, Node]] = []
        self._remember(scene.roots)
        self._remember(scene.components)
        self._remember(scene.zones)

    def _remember(self, items: list[_T]) -> None:
        before = list(items)

        def restore() -> None:
            items[:] = before

        self._undo.append(restore)

    def add(
        self, roots: Sequence[Node], components: Iterable[ComponentDeclaration], carrier: Node | None = None
    ) -> None:
        """Add nodes without parents, with all nodes below them, and declarations of components.

        Args:
            carrier: the node of the scene to which they are attached, with the same relative poses; None for the world.

        Raises:
            ValueError: a name already exists, or a node has a parent.
        """
        for root in roots:
            if root.parent is not None:
                raise ValueError(
                    f"'{root.name}' is attached to '{root.parent.name}': only nodes without a parent can be added"
                )
        self._demand_new_names([node for root in roots for node in root.walk()], {n.name for n in self.scene.nodes()})
        if carrier is None:
            self.scene.roots.extend(roots)
        else:
            for root in roots:
                self.attach(root, carrier)
        self.scene.components.extend(components)

    def attach(self, node: Node, parent: Node, place: int | None = None) -> None:
        """Attach a node without a parent to another node; ``place`` is its number among the children there."""
        self._remember(parent.children)
        self._parents.append((node, node.parent))
        parent.children.insert(len(parent.children) if place is None else place, node)
        node.parent = parent

    @staticmethod
    def _demand_new_names(nodes: Iterable[Node], names: set[str]) -> None:
        for node in nodes:
            if node.name in names:
                raise ValueError(f"there is already an object '{node.name}'; names are unique in a scene")
            names.add(node.name)

    def arrange(self, roots: Sequence[Node], components: Sequence[ComponentDeclaration], zones: Sequence[Zone]) -> None:
        """Set the nodes and components of the scene to exactly these, in this order."""
        self.scene.roots[:], self.scene.components[:], self.scene.zones[:] = roots, components, zones

    def remove(self, nodes: Iterable[Node]) -> None:
        """Remove nodes and all nodes below them, with their components and zones."""
        scene = self.scene
        gone: set[Node] = set()
        for node in nodes:
            gone.update(node.walk())
            siblings = scene.roots if node.parent is None else node.parent.children
            if node.parent is not None:
                self._remember(siblings)
                self._parents.append((node, node.parent))
                node.parent = None
            if node in siblings:
                siblings.remove(node)
        scene.components[:] = [c for c in scene.components if c.node not in gone and c.robot not in gone]
        scene.zones[:] = [zone for zone in scene.zones if zone.node not in gone]

    def replace(self, old: Node, new: Node) -> None:
        """Replace a node, with all nodes below it, by another node.

        Declarations of components and zones are transferred to the node of the same name.

        Raises:
            ValueError: a name already exists, or nodes that carry components are missing below the new node.
        """
        scene = self.scene
        old_nodes, come = set(old.walk()), {node.name: node for node in new.walk()}
        self._demand_new_names(new.walk(), {node.name for node in scene.nodes() if node not in old_nodes})
        carried = [(c, c.node, c.robot) for c in scene.components if c.node in old_nodes or c.robot in old_nodes]
        absent = sorted(
            {node.name for _, *both in carried for node in both if node in old_nodes and node.name not in come}
        )
        if absent:
            raise ValueError(f"'{new.name}' lacks {', '.join(absent)}, which carry components")
        self._declared += carried
        for component, node, robot in carried:
            component.node = come[node.name] if node in old_nodes else node
            component.robot = come[robot.name] if robot in old_nodes else robot
        siblings = scene.roots if old.parent is None else old.parent.children
        if old.parent is not None:
            self._remember(siblings)
        self._parents += [(old, old.parent), (new, new.parent)]
        siblings[siblings.index(old)] = new
        new.parent, old.parent = old.parent, None
        for zone in scene.zones:
            if zone.node in old_nodes and zone.node.name in come:
                zone.node = come[zone.node.name]

    def move(self, node: Node, parent: Node) -> None:
        """Attach a node to another parent node, with the same relative pose."""
        siblings = self.scene.roots if node.parent is None else node.parent.children
        self._remember(siblings)
        self._remember(parent.children)
        self._parents.append((node, node.parent))
        siblings.remove(node)
        parent.children.append(node)
        node.parent = parent

    def undo(self) -> None:
        """Restore the scene before the change."""
        for restore in reversed(self._undo):
            restore()
        for node, parent in reversed(self._parents):
            node.parent = parent
        for component, node, robot in reversed(self._declared):
            component.node, component.robot = node, robot
