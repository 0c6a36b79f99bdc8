"""The poses of the world, as recordings and other observers read them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from morse.core.world.body import Body
    from morse.core.world.snapshots import PoseTable, Snapshots
    from morse.scene import Node


class WorldPoses(Protocol):
    """The poses of all rigid groups, and what has changed.

    Attributes:
        stamp: a value that changes whenever an object has moved.
        displacements: number of changes of poses within a rigid group.
        relocated: the static groups that were moved by explicit calls.
        repaint_sinks: callbacks for objects whose appearance has changed.
    """

    stamp: int
    displacements: int
    relocated: set[int]
    repaint_sinks: list[Callable[[Body], object]]

    @property
    def positions(self) -> PoseTable:
        """The positions (K, 3) of the rigid groups, m: rows that are replaced, not changed."""

    @property
    def rotations(self) -> PoseTable:
        """The rotations (K, 9) of the rigid groups: rows that are replaced, not changed."""

    @property
    def layout(self) -> int:
        """A value that changes whenever `moving_nodes` changes."""

    def moving_nodes(self) -> list[tuple[Node, str]]:
        """Return the nodes whose poses change, each with its frame, ``world`` or ``parent``."""

    def snapshots(self, objects: Sequence[Body]) -> Snapshots:
        """Create a source of snapshots of the poses of some objects."""
