"""The choice of collision shapes by scene scripts."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.assets.body_settings import COLLISIONS
from morse.builder.errors import checks

if TYPE_CHECKING:
    from collections.abc import Iterable

    from morse.scene import Node


def set_collision(nodes: Iterable[Node], value: object, what: str) -> None:
    """Let the meshes among nodes that collide have collision shapes of one kind.

    Args:
        value: a key of `COLLISIONS`.
        what: the argument, for messages.

    Raises:
        TypeError: the value is not a string.
        ValueError: there is no such kind.
    """
    bounds = COLLISIONS[checks.choice(value, [name for name, kind in COLLISIONS.items() if kind], what)]
    for node in nodes:
        if node.mesh is not None and node.shapes is None and (node.body.collides or node.body.ghost):
            node.body.bounds = bounds
