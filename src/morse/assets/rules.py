"""Derives physics types for the nodes of a model file.

The settings of an object are combined by `settle`. Without settings, the role of the file determines the type:
`resolve_auto`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from morse.assets.body_settings import SETTINGS, Settled, settle
from morse.assets.gathering import gather_under_root
from morse.scene import PhysicsType

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from morse.scene import Node

__all__ = ["SETTINGS", "Settled", "gather_under_root", "resolve_auto", "settle"]


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
