"""Selects objects of a model file for the scene, and copies them with resolved physics settings."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from morse.assets import instantiate
from morse.mathutils import Matrix
from morse.scene import Choice, Control, ModelUse, PhysicsType
from morse.scene.articulation import CONTROL

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from morse.scene import Library, Node, Role


#: name of the camera in the file of a world that defines the initial viewpoint of the live view
_VIEWPOINT = "CameraFP"


def viewpoint_of(library: Library) -> Node | None:
    """The camera ``CameraFP`` of a world, which is not an object of the scene."""
    return next((root for root in library.roots if root.name == _VIEWPOINT and root.camera is not None), None)


def take(library: Library, choice: Choice) -> tuple[list[Node], ModelUse]:
    """Return copies of objects of a library, and the record of their origin.

    Returns:
        The copies without a parent, a whole component first, empty if nothing matches; and their `ModelUse`.

    Raises:
        AssetError: a whole component is wanted, and the file contains no object.
    """
    if choice.whole:
        roots = [whole_component(library, choice.role), *_beside_the_robot(library)]
    else:
        roots = pick(library, choice.role, choice.names, choice.prefix)
        if library.has_free_joints:
            for node in (node for root in roots for node in root.walk() if node.bones):
                node.properties.setdefault(CONTROL, str(Control.EFFORT))
    originals = {node.name: node for root in roots for node in instantiate(root).walk()}
    nodes = {node.name: node for root in roots for node in root.walk()}
    return roots, ModelUse(str(Path(library.path).absolute()), choice, nodes, originals)


def _beside_the_robot(library: Library) -> list[Node]:
    """Copies of the other objects of the file of a robot, without static ones of a world: scenes have a floor."""
    others = [root for root in library.roots if library.robot and root.name != library.robot]
    return [instantiate(root) for root in others if root.body.moves or (root.articulation and root.articulation.model)]


def whole_component(library: Library, role: Role = "component") -> Node:
    """Return all objects of a file as one: the root of a robot, sensor or actuator.

    Raises:
        AssetError: the file contains no object.
    """
    from morse.assets.rules import gather_under_root

    roots = [root for root in library.roots if not library.robot or root.name == library.robot]
    root = gather_under_root(replace(library, roots=[instantiate(root) for root in roots]))
    _settle_physics([root], role)
    return root


def _settle_physics(roots: list[Node], role: Role) -> None:
    from morse.assets.rules import resolve_auto

    if role != "casing":
        resolve_auto(roots, role=role)
        return
    for root in roots:
        for node in root.walk():
            if node.body.type is PhysicsType.AUTO:
                node.body.type = PhysicsType.NO_COLLISION


def pick(
    library: Library,
    role: Role,
    names: Sequence[str] | None = None,
    prefix: str | None = None,
) -> list[Node]:
    """Return copies of objects of a library, each with all objects below it.

    Objects whose names begin with ``_`` are skipped, with all objects below them.

    Args:
        library: the content of the file; it is not modified.
        role: role of the objects in the scene.
        names: only objects with these names.
        prefix: only objects whose names begin with it; if there are none, those in the collection of that name.

    Returns:
        The copies without a parent, in the order of the file; empty if nothing matches.
    """
    if names is not None:
        nodes = [node for node in library.nodes() if node.name in names]
    elif prefix is not None:
        matches = [node for node in library.nodes() if node.name.startswith(prefix)]
        members = set(library.collections.get(prefix, ()))
        nodes = matches or [node for node in library.nodes() if node.name in members]
    else:
        viewpoint = viewpoint_of(library) if role == "environment" else None
        nodes = [root for root in library.roots if root.name not in library.outside_scene and root is not viewpoint]
    roots = [_copy(node) for node in _topmost(nodes) if not node.name.startswith("_")]
    _settle_physics(roots, role)
    return roots


def _topmost(nodes: Iterable[Node]) -> list[Node]:
    selection = dict.fromkeys(nodes)
    return [node for node in selection if not any(ancestor in selection for ancestor in node.ancestors())]


def _copy(original: Node) -> Node:
    copy = instantiate(original)
    if original.parent is not None:
        # the part keeps its pose in the file
        copy.parent_inverse = original.parent.world_matrix() @ parent_inverse_of(original)
    for node in list(copy.walk()):
        if node.name.startswith("_"):
            node.detach()
    return copy


def parent_inverse_of(node: Node) -> Matrix:
    """The 4x4 matrix between a node's own pose and its parent."""
    return Matrix.Identity(4) if node.parent_inverse is None else node.parent_inverse
