"""Poses of objects at one moment, computed on demand."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from morse.mathutils.portable import matmul
from morse.physics.poses.pose_rows import PoseRows

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from morse.physics.objects.mounting import Mounted, Mounting
    from morse.physics.poses.pose_rows import Numbers
    from morse.physics.state.engine_state import EngineState


class Snapshot:
    """The poses of some objects at one moment.

    Args:
        positions, rotations: (K, 3), (K, 9) poses of all rigid groups; these arrays never change.
        slots: groups of the objects.
        mountings: poses of the objects in their groups.

    Attributes:
        group_positions, group_rotations, slots, mountings: the arguments.
    """

    __slots__ = ("group_positions", "group_rotations", "mountings", "slots")

    def __init__(
        self,
        positions: NDArray[np.float64],
        rotations: NDArray[np.float64],
        slots: Sequence[int],
        mountings: Sequence[Mounting],
    ) -> None:
        self.group_positions, self.group_rotations = positions, rotations
        self.slots, self.mountings = slots, mountings

    def pose(self, row: int) -> tuple[Sequence[float], Sequence[float]]:
        """Return the position (3) and rotation (9, row by row) of an object in the world."""
        slot = self.slots[row]
        return self.mountings[row].carried(self.group_positions[slot].tolist(), self.group_rotations[slot].tolist())

    @classmethod
    def poses_at(cls, moments: Sequence[Snapshot]) -> tuple[Numbers, Numbers]:
        """Return the positions (3) and rotations (9, row by row) of the same N objects at R moments, (R, N) each."""
        positions, rotations = [one.group_positions for one in moments], [one.group_rotations for one in moments]
        return PoseRows.of(positions, rotations, [one.mountings for one in moments]).carried(moments[0].slots)

    def positions(self) -> NDArray[np.float64]:
        """Return the positions (N, 3) in the world, m."""
        rotations = self.group_rotations[self.slots]
        offsets = np.array([mounting.offset for mounting in self.mountings])
        x, y, z = offsets.T
        columns = [rotations[:, k] * x + rotations[:, k + 1] * y + rotations[:, k + 2] * z for k in (0, 3, 6)]
        result: NDArray[np.float64] = self.group_positions[self.slots] + np.stack(columns, axis=1)
        return result

    def rotations(self) -> NDArray[np.float64]:
        """Return the rotations (N, 3, 3) from the axes of each object to those of the world."""
        offsets = np.array([mounting.turned for mounting in self.mountings]).reshape(-1, 3, 3)
        return np.asarray(matmul(self.group_rotations[self.slots].reshape(-1, 3, 3), offsets))


class Snapshots:
    """Takes snapshots of the same objects repeatedly, at little cost."""

    def __init__(self, state: EngineState, objects: Sequence[Mounted]) -> None:
        self._state, self._objects = state, objects
        self._slots = [obj.slot for obj in objects]
        self._index, self._rows = np.array(self._slots, dtype=np.int64), range(len(self._slots))
        self._displacements = -1
        self._mountings: list[Mounting] = []
        #: whether the engine moves all of them; None if that is not known
        self._moves: bool | None = None

    def place(self, row: int) -> tuple[int, Mounting]:
        """Return the group of an object, and its pose in the group."""
        if self._displacements != self._state.displacements:
            self._look()
        return self._slots[row], self._mountings[row]

    def now(self) -> Snapshot:
        """Return a snapshot of the present poses, with copies of those of the rigid groups of the objects."""
        state, index = self._state, self._index
        if self._displacements != state.displacements:
            self._look()
        positions, rotations = state.positions.array.take(index, 0), state.rotations.array.take(index, 0)
        return Snapshot(positions, rotations, self._rows, self._mountings)

    def before(self) -> Snapshot:
        """Return a snapshot of the poses at the beginning of the last tick of `World.advance`."""
        state, index = self._state, self._index
        if self._displacements != state.displacements:
            self._look()
        before_positions, before_rotations = state.poses_before
        if self._moves is None:
            self._moves = bool((index < state.moving).all())
        if self._moves:
            positions, rotations = before_positions.take(index, 0), before_rotations.take(index, 0)
        else:
            positions, rotations = state.positions.array.take(index, 0), state.rotations.array.take(index, 0)
            rows = np.flatnonzero(index < state.moving)
            positions[rows], rotations[rows] = before_positions[index[rows]], before_rotations[index[rows]]
        return Snapshot(positions, rotations, self._rows, self._mountings)

    def _look(self) -> None:
        self._displacements = self._state.displacements
        self._mountings = [obj.mounting for obj in self._objects]
