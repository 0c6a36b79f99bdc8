"""Derives physics types for the nodes of a model file.

Without settings of its own (`morse.assets.body_settings`), the role of a file determines the type of an object:
`resolve_auto`.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Literal

from morse.assets.errors import AssetError
from morse.scene import NodeKind, PhysicsType
from morse.scene.frames import attach_in_place, set_free

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from morse.scene import Library, Node


def gather_under_root(library: Library) -> Node:
    """Return the root node of a robot, sensor or actuator whose file may contain several loose objects.

    The root is the object with the name of the file, else the first one that has children, physics or no mesh, else the
    first mesh. All other objects become children of the root with their present poses. Lights, cameras and objects
    whose names begin with ``_`` are dropped.

    Raises:
        AssetError: the file does not contain an object that could be a component.
    """
    scene_roots = [root for root in library.roots if root.name not in library.outside_scene]
    loose = [part for root in scene_roots or library.roots for part in _without_lights(root)]
    if not loose:
        raise AssetError(library.path, "it contains no object that could be a component: add a mesh or an empty")
    root = _choose(loose, Path(library.path).stem)
    for part in loose:
        if part is not root:
            attach_in_place(root, part)
    library.roots = [root]
    return root


def _without_lights(root: Node) -> list[Node]:
    """Remove lights, cameras and private objects from a tree, and return the remaining trees."""
    if _is_private(root):
        return []
    for node in list(root.walk()):
        if node is root or node.parent is None:
            continue
        if _is_private(node):
            node.detach()
        elif _is_light(node):
            for child in list(node.children):
                attach_in_place(node.parent, child)
            node.detach()
    if not _is_light(root):
        return [root]
    children = list(root.children)
    for child in children:
        set_free(child)
    return [tree for child in children for tree in _without_lights(child)]


def _is_private(node: Node) -> bool:
    return (node.source_name or node.name).startswith("_")


def _is_light(node: Node) -> bool:
    return node.kind in (NodeKind.LIGHT, NodeKind.CAMERA)


def _choose(loose: list[Node], stem: str) -> Node:
    for node in loose:
        if (node.source_name or node.name).casefold() == stem.casefold():
            return node
    for node in loose:
        has_type = node.body.type not in (PhysicsType.AUTO, PhysicsType.NO_COLLISION)
        if node.children or has_type or node.kind is NodeKind.EMPTY:
            return node
    return next((node for node in loose if node.mesh is not None), loose[0])


def resolve_auto(roots: Iterable[Node], *, role: Literal["environment", "component", "prop"]) -> None:
    """Assign a physics type to the nodes of one file for which the file does not specify it.

    Nodes below a moving body become its shapes if no other node does, otherwise decoration. Other nodes of an
    environment are static. A component or prop without any settings becomes one rigid body of all its meshes; with some
    settings, only these apply.
    """
    roots = list(roots)
    nodes = [node for root in roots for node in root.walk()]
    has_types = any(node.body.type is not PhysicsType.AUTO for node in nodes)
    if role != "environment" and not has_types:
        for root in roots:
            root.body.type, root.body.compound = PhysicsType.RIGID_BODY, True
    for node in nodes:
        if node.body.moves:
            _complete(node)
    for node in nodes:
        if node.body.type is PhysicsType.AUTO:
            has_shape = node.mesh is not None and (role == "environment" or node.body.bounds is not None)
            node.body.type = PhysicsType.STATIC if has_shape else PhysicsType.NO_COLLISION


def _complete(body: Node) -> None:
    """Assign types to the undecided nodes below a moving node."""
    parts = list(_parts(body))
    open_nodes = [node for node in parts if node.mesh is not None and node.body.type is PhysicsType.AUTO]
    with_bounds = [node for node in open_nodes if node.body.bounds is not None]
    own = body.mesh is not None and body.shapes is None
    has_collisions = any(node.body.collides and node.mesh is not None for node in parts)
    bodies = with_bounds if with_bounds or has_collisions or (own and not body.body.compound) else open_nodes
    for node in parts:
        if node.body.type is PhysicsType.AUTO:
            node.body.type = PhysicsType.RIGID_BODY if node in bodies else PhysicsType.NO_COLLISION


def _parts(body: Node) -> Iterator[Node]:
    """The nodes below a body."""
    walk = body.walk()
    next(walk)
    return walk
