"""Poses of objects at one moment, computed on demand."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

import numpy as np

from morse.mathutils.portable import matmul
from morse.physics.model.layout import Motion
from morse.physics.objects.mounting import Mounted, Mounting
from morse.physics.poses import rigid

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from morse.physics.model.compile import Slot
    from morse.physics.state.engine_state import EngineState
    from morse.scene import Node


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

    def now(self) -> Snapshot:
        """Return a snapshot of the present poses, with the poses of all rigid groups."""
        state = self._state
        if self._displacements != state.displacements:
            self._look()
        return Snapshot(state.positions.share(), state.rotations.share(), self._slots, self._mountings)

    def copy(self) -> Snapshot:
        """Return a snapshot of the present poses, with copies of those of the rigid groups of the objects."""
        state, index = self._state, self._index
        if self._displacements != state.displacements:
            self._look()
        positions, rotations = state.positions.array.take(index, 0), state.rotations.array.take(index, 0)
        return Snapshot(positions, rotations, self._rows, self._mountings)

    def _look(self) -> None:
        self._displacements = self._state.displacements
        self._mountings = [obj.mounting for obj in self._objects]


class Moving(Mounted, Protocol):
    """An object that has a velocity; see `morse.physics.objects.gameobject.GameObject`."""

    node: Node

    def velocity(self) -> tuple[Sequence[float], Sequence[float]]:
        """Return its linear and angular velocity, in world axes."""


class VelocitySnapshot:
    """The velocities of some bodies at one moment.

    Args:
        snapshot: their poses.
        velocities: (V,) velocities of the engine; the array never changes.
        dofs: index of the velocities of each body; -1 for an object that is not the first of its group, or has no
            velocity in the engine.
        others: velocities of the objects with dof -1, by row.
    """

    __slots__ = ("_dofs", "_others", "_snapshot", "_velocities")

    def __init__(
        self,
        snapshot: Snapshot,
        velocities: NDArray[np.float64],
        dofs: Sequence[int],
        others: dict[int, tuple[Sequence[float], Sequence[float]]],
    ) -> None:
        self._snapshot, self._velocities, self._dofs, self._others = snapshot, velocities, dofs, others

    def velocity(self, row: int) -> tuple[Sequence[float], Sequence[float]]:
        """Return the linear (m/s) and angular velocity (rad/s) of the origin of a body, in world axes."""
        dof = self._dofs[row]
        if dof < 0:
            return self._others[row]
        speeds = self._velocities[dof : dof + 6].tolist()
        return speeds[:3], rigid.turn(self._snapshot.pose(row)[1], speeds[3:])

    def origin(self, row: int) -> Sequence[float]:
        """Return the position of the origin of a body in the world, m."""
        return self._snapshot.pose(row)[0]


class VelocitySnapshots:
    """Reads the velocities of the same bodies repeatedly."""

    def __init__(self, state: EngineState, objects: Sequence[Moving]) -> None:
        self._state = state
        self._poses = Snapshots(state, objects)
        self._dofs = [_dof_of(obj, state.slots[obj.slot]) for obj in objects]
        self._others = [(row, obj) for row, obj in enumerate(objects) if self._dofs[row] < 0]

    def now(self) -> VelocitySnapshot:
        """Return the present velocities."""
        others = {row: obj.velocity() for row, obj in self._others}
        return VelocitySnapshot(self._poses.now(), self._state.data.qvel.copy(), self._dofs, others)


def _dof_of(obj: Moving, slot: Slot) -> int:
    return slot.dof if slot.frame.motion is Motion.FREE and slot.frame.node is obj.node else -1
