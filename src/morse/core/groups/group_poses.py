"""The poses of the members of a group at one moment."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from morse.helpers.transformation import Transformation3d

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray


class GroupPoses:
    """Poses in the world, computed only for the requested rows.

    Attributes:
        snapshot: see `morse.physics.poses.snapshot.Snapshot`.
    """

    __slots__ = ("snapshot",)

    def __init__(self, snapshot: Any) -> None:
        self.snapshot = snapshot

    def pose(self, row: int) -> tuple[Sequence[float], Sequence[float]]:
        """Position (3), m, and rotation (9, row by row) of a member."""
        pose: tuple[Sequence[float], Sequence[float]] = self.snapshot.pose(row)
        return pose

    def numbers(self, row: int) -> tuple[float, float, float, float, float, float]:
        """x, y, z (m), yaw, pitch and roll (rad) of a member."""
        return self.transformation(row).numbers()

    def transformation(self, row: int) -> Transformation3d:
        """Return the pose of a member."""
        transformation = Transformation3d()
        transformation.set_pose(*self.snapshot.pose(row))
        return transformation

    def positions(self) -> NDArray[Any]:
        """Positions (N, 3), m."""
        positions: NDArray[Any] = self.snapshot.positions()
        return positions

    def rotations(self) -> NDArray[Any]:
        """Rotations (N, 3, 3) from the axes of each member to those of the world."""
        rotations: NDArray[Any] = self.snapshot.rotations()
        return rotations
