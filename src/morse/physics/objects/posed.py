"""The protocol of objects with a pose in the world."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from collections.abc import Sequence

    from morse.scene import Node


class Posed(Protocol):
    """An object with a pose in the world; see `morse.physics.objects.gameobject.GameObject`.

    Attributes:
        node: the node of the scene for this object.
        slot: index of the rigid group of the object.
    """

    node: Node
    slot: int

    def world_pose(self) -> tuple[Sequence[float], Sequence[float]]:
        """Position (3) and rotation (9, row-major) in the world."""
