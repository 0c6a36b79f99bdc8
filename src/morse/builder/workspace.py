"""The scene while a script describes it."""

from __future__ import annotations

import copy
import logging
import re
from contextlib import contextmanager
from typing import TYPE_CHECKING

from morse.builder.names import frames
from morse.core.exceptions import MorseBuilderError
from morse.scene import Settings

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator
    from types import ModuleType

    from morse.builder.assembly.description import EnvironmentDescription
    from morse.builder.names.part import Part
    from morse.scene import Material, Mesh, ModelUse, Node, SourceLine

#: collision shapes, rays and images take about 1 kB for each
MOST_TRIANGLES = 10_000_000
#: number of meshes that the message names
_NAMED = 5


class TriangleLimit:
    """Counts the triangles of the meshes of a scene; a mesh that several nodes share counts once."""

    def __init__(self) -> None:
        #: keeps the meshes alive, so that their ids are not reused
        self._meshes: dict[int, Mesh] = {}
        self._count = 0

    def add(self, node: Node, nodes: Iterable[Node]) -> None:
        """Count the mesh of a node.

        Args:
            nodes: all nodes of the scene; they are counted again before an error, because some may have been deleted.

        Raises:
            MorseBuilderError: the meshes have more than `MOST_TRIANGLES`.
        """
        mesh = node.mesh
        if mesh is None or id(mesh) in self._meshes:
            return
        self._meshes[id(mesh)] = mesh
        self._count += len(mesh.triangles)
        if self._count > MOST_TRIANGLES:
            owners = {id(mesh): (mesh, name) for mesh, name in _named(nodes)}
            self._meshes = {key: mesh for key, (mesh, _) in owners.items()}
            self._count = sum(len(mesh.triangles) for mesh in self._meshes.values())
            if self._count > MOST_TRIANGLES:
                raise MorseBuilderError(_message(self._count, [*owners.values()]))


def _named(nodes: Iterable[Node]) -> Iterator[tuple[Mesh, str]]:
    for node in nodes:
        if node.mesh is not None:
            yield node.mesh, node.name


def _message(count: int, owners: list[tuple[Mesh, str]]) -> str:
    owners.sort(key=lambda owner: -len(owner[0].triangles))
    largest = ", ".join(f"'{name}' ({len(mesh.triangles):,})" for mesh, name in owners[:_NAMED])
    return (
        f"the scene has {count:,} triangles, and the limit is {MOST_TRIANGLES:,}; the largest meshes are those of "
        f"{largest}; reduce their triangles, for example with the modifier 'Decimate' of Blender"
    )


_SUFFIX = re.compile(r"\.\d{3,}$")


class Workspace:
    """All nodes and components created so far, with unique names.

    Attributes:
        roots: nodes without a parent, in the order of creation.
        components: robots, sensors, other objects, ... in the order of creation.
        models: the model files from which nodes were loaded.
        environment: the environment, once the script has created it.
        selected: the active node: the last one that was created or selected.
        selection: the nodes that old scripts have selected.
        settings: the settings of the scene, which the environment takes over.
        materials: materials that old scripts have created.
        notices: what the log has said about old code, with the line.
        speed: frequency that ``bpymorse.set_speed`` has set before the environment exists.
        script: the script itself, kept so that its functions still find their names.

    Args:
        most_components: the largest number of components; None for any number.
    """

    def __init__(self, most_components: int | None = None) -> None:
        self._most_components = most_components
        self.roots: list[Node] = []
        self.components: list[Part] = []
        self.models: list[ModelUse] = []
        self.environment: EnvironmentDescription | None = None
        self.selected: Node | None = None
        self.selection: list[Node] = []
        self.settings = Settings()
        self.materials: list[Material] = []
        self.notices: set[tuple[SourceLine | None, str]] = set()
        self.speed: tuple[float, int, int] | None = None
        self.script: ModuleType | None = None
        self._nodes: dict[str, Node] = {}
        self._counters: dict[str, int] = {}
        self._triangles = TriangleLimit()

    def register(self, component: Part) -> None:
        """Add a component.

        Raises:
            MorseBuilderError: there are too many.
        """
        if self._most_components is not None and len(self.components) >= self._most_components:
            raise MorseBuilderError(
                f"it has more than {self._most_components} robots, sensors and actuators, which is the budget for what "
                "a client spawns; a scene script may have any number"
            )
        self.components.append(component)

    def add(self, root: Node) -> None:
        """Add a node and all nodes below it to the scene; ``.001``, ``.002``, ... is appended to existing names.

        Raises:
            MorseBuilderError: the scene has too many triangles.
        """
        for node in root.walk():
            node.name = self._unique(node.name)
            self._nodes[node.name] = node
            self._triangles.add(node, self._nodes.values())
        self.roots.append(root)
        self.selected = root

    def add_model(self, roots: Iterable[Node], use: ModelUse) -> None:
        """Add nodes of a model file to the scene."""
        for root in roots:
            self.add(root)
        self.models.append(use)

    def reserve(self, nodes: Iterable[Node]) -> None:
        """Reserve the names of nodes that are not part of this scene."""
        for node in nodes:
            self._nodes[node.name] = node

    def attach(self, parent: Node, child: Node, *, keep_world_pose: bool = False) -> None:
        """Make a node the child of another one.

        Raises:
            ValueError: the node would become its own ancestor.
        """
        was_root = child.parent is None
        parent.attach(child, keep_world_pose=keep_world_pose)
        if was_root:
            self.roots.remove(child)

    def detach(self, child: Node) -> None:
        """Remove the parent of a node."""
        if child.parent is not None:
            child.detach()
            self.roots.append(child)

    def delete(self, node: Node) -> None:
        """Remove a node from the scene; its children become roots and keep their world poses."""
        for child in list(node.children):
            above = node.world_matrix()
            inverse = above if child.parent_inverse is None else above @ child.parent_inverse
            self.detach(child)
            child.parent_inverse = inverse
        self.detach(node)
        self.roots.remove(node)
        del self._nodes[node.name]
        self.selection = [other for other in self.selection if other is not node]
        if self.selected is node:
            self.selected = None

    def mark(self) -> tuple[int, Node | None]:
        """What `return_to` needs to know of the scene as it is."""
        return len(self.components), self.roots[-1] if self.roots else None

    def return_to(self, mark: tuple[int, Node | None]) -> None:
        """Remove the components, and the nodes without an older parent, that were created since `mark`."""
        count, last = mark
        del self.components[count:]
        if last is None or last in self.roots:
            for root in self.roots[0 if last is None else self.roots.index(last) + 1 :]:
                for node in reversed(list(root.walk())):
                    self.delete(node)

    def duplicate(self, node: Node) -> Node:
        """A copy of a node in the same place, without the nodes below it."""
        twin = copy.copy(node)
        twin.children, twin.parent = [], None
        twin.location, twin.rotation_euler, twin.scale = (
            list(node.location),
            list(node.rotation_euler),
            list(node.scale),
        )
        twin.materials, twin.properties = list(node.materials), dict(node.properties)
        twin.body, twin.light, twin.camera = copy.copy(node.body), copy.copy(node.light), copy.copy(node.camera)
        self.add(twin)
        if node.parent is not None:
            self.attach(node.parent, twin)
            twin.parent_inverse = node.parent_inverse
        return twin

    def find(self, name: str) -> Node | None:
        """The node of that name, or None."""
        return self._nodes.get(name)

    def nodes(self) -> Iterator[Node]:
        """Every node, parents before their children."""
        for root in self.roots:
            yield from root.walk()

    def names(self) -> list[str]:
        """The names of all nodes."""
        return list(self._nodes)

    def rename(self, node: Node, name: str) -> None:
        """Set the name of a node, made unique by ``.001``, ``.002``, ... if another node has it."""
        if node.name != name:
            # parts that were attached to a node directly are not known yet
            if self._nodes.get(node.name) is node:
                del self._nodes[node.name]
            node.name = self._unique(name)
            self._nodes[node.name] = node

    def claim(self, node: Node, name: str) -> None:
        """Set the name of a node; another node with that name is renamed."""
        holder = self._nodes.get(name)
        if holder is not None and holder is not node:
            del self._nodes[node.name]
            node.name = name
            self._nodes[name] = node
            holder.name = self._unique(name)
            self._nodes[holder.name] = holder
        else:
            self.rename(node, name)

    def _unique(self, name: str) -> str:
        if name not in self._nodes:
            return name
        stem = _SUFFIX.sub("", name)
        count = self._counters.get(stem, 0)
        while True:
            count += 1
            candidate = f"{stem}.{count:03d}"
            if candidate not in self._nodes:
                self._counters[stem] = count
                return candidate


_current = Workspace()
_described = 0


def current() -> Workspace:
    """The scene that is being described."""
    return _current


def reset() -> Workspace:
    """Begin an empty scene and return it."""
    global _current
    _current = Workspace()
    return _current


@contextmanager
def described(most_components: int | None = None) -> Iterator[Workspace]:
    """An empty scene, which is the current scene within the block; see `Workspace`."""
    global _current, _described
    before, _current = _current, Workspace(most_components)
    _described += 1
    try:
        yield _current
    finally:
        _current = before
        _described -= 1


def is_being_described() -> bool:
    """Whether a scene script is running."""
    return _described > 0


def notice(message: str, old: str = "", new: str = "") -> None:
    """Log a warning about old code with the line of the script; in a loop, the same message is logged once.

    Args:
        message: what is old, and how it is written today.
        old: a word of the line that `morse check --fix` may replace.
        new: its replacement.
    """
    where = frames.source_line()
    if (where, message) not in _current.notices:
        _current.notices.add((where, message))
        logging.getLogger("morse.builder.script").warning(
            "%s", message, extra={"where": where, "is_old": True, "edit": (old, new)}
        )
