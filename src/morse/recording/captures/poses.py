"""The poses of objects, as arrays of many ticks."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from morse.helpers.transformation import Transformation3d
from morse.kernel.memory import address
from morse.kernel.recording import Poses
from morse.middleware.ros2.parts import quaternion
from morse.recording.captures.capture import Capture

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray

    from morse.kernel.recording import Batch, NativeRecords, Rows
    from morse.physics.mounting import Mounting
    from morse.physics.snapshot import Snapshot
    from morse.recording.captures.template import Template

#: size of seven numbers, a position and a quaternion, bytes
POSE = 56
_SEVEN = np.dtype("<f8")


class Groups(NamedTuple):
    """The poses of K consecutive rigid groups in R ticks.

    Attributes:
        positions, rotations: (R,) addresses of the positions (K, 3), m, and rotations (K, 9) in each tick.
        read: returns position and rotation of a group, given the row of the tick and of the group.
        first: index of the first rigid group.
        owners: keep the memory.
    """

    positions: NDArray[np.int64]
    rotations: NDArray[np.int64]
    read: Callable[[int, int], tuple[list[float], list[float]]]
    first: int
    owners: Any

    def some(self, rows: NDArray[np.int64]) -> Groups:
        """Return the poses of some of the ticks."""
        read, chosen = self.read, rows.tolist()
        positions, rotations = self.positions[rows], self.rotations[rows]
        return Groups(positions, rotations, lambda row, group: read(chosen[row], group), self.first, self.owners)


def groups_of_arrays(
    positions: Sequence[NDArray[np.float64]],
    rotations: Sequence[NDArray[np.float64]],
    first: int = 0,
    places: Sequence[Sequence[int]] | None = None,
) -> Groups:
    """Return the poses in R ticks from arrays (K, 3) and (K, 9) of each, and their addresses; 0 if not known."""
    p, r = map(_addresses, (positions, rotations), places or ((0,), (0,)))
    return Groups(
        p,
        r,
        lambda row, group: (positions[row][group].tolist(), rotations[row][group].tolist()),
        first,
        (positions, rotations),
    )


def _addresses(arrays: Sequence[NDArray[np.float64]], places: Sequence[int]) -> NDArray[np.int64]:
    if 0 in places:
        places = [place or address(array) or 0 for place, array in zip(places, arrays, strict=True)]
    return np.array(places, dtype=np.int64)


def groups_of_bytes(positions: Sequence[bytes], rotations: Sequence[bytes], first: int) -> Groups:
    """Return the poses in R ticks from the bytes of these arrays."""
    count = len(positions)
    p, r = (np.frombuffer(b"".join(each)).reshape(count, -1, size) for each, size in ((positions, 3), (rotations, 9)))
    places = [one.ctypes.data + one.strides[0] * np.arange(count) for one in (p, r)]
    return Groups(
        places[0], places[1], lambda row, group: (p[row, group].tolist(), r[row, group].tolist()), first, (p, r)
    )


def groups_of(snapshot: Snapshot) -> Groups:
    """Return the poses of a snapshot as those of one tick."""
    return groups_of_arrays([snapshot.group_positions], [snapshot.group_rotations])


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
        slots = self._slots - groups.first
        mounted = self._offsets, self._turned, self._apart
        poses = Poses(groups.positions, groups.rotations, slots, *mounted, self._places)
        self._encoded(batch, rows, poses, lambda left: self._mend(rows, groups, left))

    def _mend(self, rows: Rows, groups: Groups, left: NDArray[np.uint8]) -> None:
        for row, member in np.argwhere(left).tolist():
            at = groups.read(row, self.slots[member] - groups.first)
            pose = Transformation3d()
            pose.set_pose(*self.mountings[member].carried(*at))
            position, wxyz = self._one(member, pose)
            turned = quaternion(wxyz) or {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0}
            numbers = [*position, turned["x"], turned["y"], turned["z"], turned["w"]]
            begin = int(rows.begins[row] + self._places[member])
            rows.chunk[begin : begin + POSE] = np.array(numbers, dtype=_SEVEN).view(np.uint8)

    def _encoded(self, batch: Batch, rows: Rows, poses: Poses, mend: Callable[[NDArray[np.uint8]], object]) -> None:
        """Add the step of the kernel; `mend` writes the messages that are left to Python, (R, N) 1 for each."""
        raise NotImplementedError

    def _one(self, member: int, pose: Transformation3d) -> tuple[Sequence[float], Sequence[float]]:
        """Return position and quaternion w, x, y, z of a message, in Python."""
        raise NotImplementedError
