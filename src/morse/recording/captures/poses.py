"""The poses of objects, as arrays of many ticks."""

from __future__ import annotations

from ctypes import c_double, sizeof
from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from morse.helpers.transformation import Transformation3d
from morse.kernel.memory import address
from morse.kernel.recording import Poses
from morse.recording.captures.capture import Capture
from morse.rosmsgs.parts import quaternion

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray

    from morse.kernel.recording import Batch, NativeRecords, Rows
    from morse.physics.objects.mounting import Mounting
    from morse.physics.poses.snapshot import Snapshot
    from morse.recording.captures.template import Template

    #: returns the pose of a rigid group
    Read = Callable[[int], tuple[Sequence[float], Sequence[float]]]

#: size of seven numbers, a position and a quaternion, bytes
POSE = 56
_SEVEN = np.dtype("<f8")
_Position, _Rotation = c_double * 3, c_double * 9


class Groups(NamedTuple):
    """The poses of all rigid groups in R ticks.

    Attributes:
        positions, rotations: (R,) addresses of the positions (K, 3), m, and rotations (K, 9) in each tick.
        owners: keep the memory.
    """

    positions: NDArray[np.int64]
    rotations: NDArray[np.int64]
    owners: Any

    def some(self, rows: NDArray[np.int64]) -> Groups:
        """Return the poses of some of the ticks."""
        return Groups(self.positions[rows], self.rotations[rows], self.owners)

    def read(self, row: int, group: int) -> tuple[list[float], list[float]]:
        """Position and rotation of a group, given the row of the tick and the index of the group."""
        position = _Position.from_address(int(self.positions[row]) + sizeof(_Position) * group)
        rotation = _Rotation.from_address(int(self.rotations[row]) + sizeof(_Rotation) * group)
        return list(position), list(rotation)


def groups_of_arrays(
    positions: Sequence[NDArray[np.float64]],
    rotations: Sequence[NDArray[np.float64]],
    position_places: Sequence[int],
    rotation_places: Sequence[int],
) -> Groups:
    """Return the poses in R ticks from arrays (K, 3) and (K, 9) of each, and their addresses.

    An address that is not positive is the distance, in bytes, of the first rigid group of all from the begin of the
    array.
    """
    found = _addresses(positions, position_places), _addresses(rotations, rotation_places)
    return Groups(*found, (positions, rotations))


def _addresses(arrays: Sequence[NDArray[np.float64]], places: Sequence[int]) -> NDArray[np.int64]:
    found = np.array(places, dtype=np.int64)
    if (found > 0).all():
        return found
    pairs = zip(places, arrays, strict=True)
    return np.array([place if place > 0 else (address(array) or 0) + place for place, array in pairs], dtype=np.int64)


def groups_of(snapshot: Snapshot) -> Groups:
    """Return the poses of a snapshot as those of one tick."""
    return groups_of_arrays([snapshot.group_positions], [snapshot.group_rotations], [0], [0])


class PosesCapture(Capture):
    """Messages with a position and a quaternion each.

    The stored data of R ticks are the `Groups` of each.

    Attributes:
        slots: rigid group of each object.
        mountings: pose of each object in its group.

    Args:
        native: the encoder.
        template: the messages.
        places: (N,) offset of the numbers of each message in the template.
        slots: rigid group of each object.
        mountings: pose of each object in its group.
    """

    def __init__(
        self,
        native: NativeRecords,
        template: Template,
        places: NDArray[np.int64],
        slots: Sequence[int],
        mountings: Sequence[Mounting],
    ) -> None:
        super().__init__(native, template)
        self._places, self.slots, self.mountings = places, slots, mountings
        self._slots = np.array(slots, dtype=np.int64)
        self._offsets = np.array([one.offset for one in mountings], dtype=np.float64).reshape(-1, 3)
        self._turned = np.array([one.turned for one in mountings], dtype=np.float64).reshape(-1, 9)
        apart = [1 + one.is_turned if one.is_apart else 0 for one in mountings]
        self._apart = np.array(apart, dtype=np.uint8)

    def _fill(self, batch: Batch, rows: Rows, data: Any) -> None:
        groups: Groups = data
        mounted = self._offsets, self._turned, self._apart
        poses = Poses(groups.positions, groups.rotations, self._slots, *mounted, self._places)
        self._encoded(batch, rows, poses, lambda left: self._mend(rows, groups, left))

    def _mend(self, rows: Rows, groups: Groups, left: NDArray[np.uint8]) -> None:
        for row, member in np.argwhere(left).tolist():
            at = groups.read(row, self.slots[member])
            pose = Transformation3d()
            pose.set_pose(*self.mountings[member].carried(*at))
            position, wxyz = self._one(member, pose, partial(groups.read, row))
            turned = quaternion(wxyz) or {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0}
            numbers = [*position, turned["x"], turned["y"], turned["z"], turned["w"]]
            begin = int(rows.begins[row] + self._places[member])
            rows.chunk[begin : begin + POSE] = np.array(numbers, dtype=_SEVEN).view(np.uint8)

    def _encoded(self, batch: Batch, rows: Rows, poses: Poses, mend: Callable[[NDArray[np.uint8]], object]) -> None:
        """Add the step of the kernel.

        Args:
            batch: receives the step.
            rows: see `Rows`.
            poses: see `Poses`.
            mend: writes the messages that are left to Python, (R, N) 1 for each.
        """
        raise NotImplementedError

    def _one(self, member: int, pose: Transformation3d, read: Read) -> tuple[Sequence[float], Sequence[float]]:
        """Return position and quaternion w, x, y, z of a message, in Python.

        Args:
            member: number of the object.
            pose: of the object in the world.
            read: returns the pose of a rigid group at the same time.
        """
        raise NotImplementedError
