"""Poses of objects at one moment, computed on demand."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from morse.physics.engine_state import EngineState
    from morse.physics.mounting import Mounted, Mounting


class Snapshot:
    """The poses of some objects at one moment.

    Args:
        positions, rotations: (K, 3), (K, 9) poses of all rigid groups; these arrays never change.
        slots: groups of the objects.
        mountings: poses of the objects in their groups.
    """

    __slots__ = ("_mountings", "_positions", "_rotations", "_slots")

    def __init__(
        self,
        positions: NDArray[np.float64],
        rotations: NDArray[np.float64],
        slots: Sequence[int],
        mountings: Sequence[Mounting],
    ) -> None:
        self._positions, self._rotations = positions, rotations
        self._slots, self._mountings = slots, mountings

    def pose(self, row: int) -> tuple[Sequence[float], Sequence[float]]:
        """Return the position (3) and rotation (9, row by row) of an object in the world."""
        slot = self._slots[row]
        return self._mountings[row].carried(self._positions[slot].tolist(), self._rotations[slot].tolist())

    def positions(self) -> NDArray[np.float64]:
        """Return the positions (N, 3) in the world, m."""
        turned = self._rotations[self._slots]
        offsets = np.array([mounting.offset for mounting in self._mountings])
        columns = [turned[:, k] * offsets[:, 0] + turned[:, k + 1] * offsets[:, 1] + turned[:, k + 2] * offsets[:, 2]
                   for k in (0, 3, 6)]  # fmt: skip
        moved: NDArray[np.float64] = self._positions[self._slots] + np.stack(columns, axis=1)
        return moved

    def rotations(self) -> NDArray[np.float64]:
        """Return the rotations (N, 3, 3) from the axes of each object to those of the world."""
        turned = np.array([mounting.turned for mounting in self._mountings]).reshape(-1, 3, 3)
        return np.asarray(self._rotations[self._slots].reshape(-1, 3, 3) @ turned)


class Snapshots:
    """Takes snapshots of the same objects repeatedly, at little cost."""

    def __init__(self, state: EngineState, objects: Sequence[Mounted]) -> None:
        self._state, self._objects = state, objects
        self._slots = [obj.slot for obj in objects]
        self._displacements = -1
        self._mountings: list[Mounting] = []

    def now(self) -> Snapshot:
        """Return a snapshot of the present poses."""
        state = self._state
        if self._displacements != state.displacements:
            self._displacements = state.displacements
            self._mountings = [obj.mounting for obj in self._objects]
        return Snapshot(state.positions.share(), state.rotations.share(), self._slots, self._mountings)
