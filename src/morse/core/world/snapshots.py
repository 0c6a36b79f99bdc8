"""Poses of several objects at one moment, as components see them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol, Self

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy as np
    from numpy.typing import NDArray

    from morse.core.world.body import Mounting


class PoseTable(Protocol):
    """Rows of numbers, one for each rigid group, which are replaced and not changed."""

    def __len__(self) -> int: ...

    def __getitem__(self, index: int, /) -> Sequence[float]: ...

    def share(self) -> NDArray[np.float64]:
        """Return all present rows (K, D); the array does not change afterwards."""


class Snapshot(Protocol):
    """The poses of some objects at one moment.

    Attributes:
        slots: the rigid groups of the objects.
    """

    slots: Sequence[int]

    def pose(self, row: int) -> tuple[Sequence[float], Sequence[float]]:
        """Return the position (3) and rotation (9, row by row) of an object in the world."""

    def positions(self) -> NDArray[np.float64]:
        """Return the positions (N, 3) in the world, m."""

    def rotations(self) -> NDArray[np.float64]:
        """Return the rotations (N, 9) in the world, row by row."""

    @classmethod
    def poses_at(cls, moments: Sequence[Self]) -> tuple[Sequence[NDArray[np.float64]], Sequence[NDArray[np.float64]]]:
        """Return the poses (R, N) of the objects at several moments: 3 coordinates, 9 numbers of the rotations."""


class Fleet(Protocol):
    """Robots that one call drives."""

    def adopt(self, row: int) -> bool:
        """Make the present command of a robot last; return False if it has no command that can last."""

    def drive(self) -> None:
        """Drive all robots during the next tick."""


class Snapshots(Protocol):
    """Takes snapshots of the same objects repeatedly, at little cost."""

    def place(self, row: int) -> tuple[int, Mounting]:
        """Return the group of an object, and its pose in the group."""

    def now(self) -> Snapshot:
        """Return a snapshot of the present poses."""

    def before(self) -> Snapshot:
        """Return a snapshot of the poses at the beginning of the last tick of `World.step_freely`."""
