"""The poses of objects, as arrays of many ticks."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from morse.helpers.transformation import Transformation3d
from morse.kernel.recording import Poses
from morse.middleware.ros2.parts import quaternion
from morse.recording.captures.capture import Capture

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from morse.kernel.recording import NativeRecords, Rows
    from morse.physics.mounting import Mounting
    from morse.recording.captures.template import Template

#: size of seven numbers, a position and a quaternion, bytes
POSE = 56
_SEVEN = np.dtype("<f8")


class PosesCapture(Capture):
    """Messages with a position and a quaternion each.

    The stored data of R ticks are positions (R, K, 3), m, and rotations (R, K, 9) of consecutive rigid groups, and the
    index of the first of them.

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

    def _fill(self, rows: Rows, data: Any) -> None:
        positions, rotations, first = data
        poses = Poses(positions, rotations, self._slots - first, self._offsets, self._turned, self._apart, self._places)
        left = self._encoded(rows, poses)
        for row, member in np.argwhere(left).tolist() if left.any() else ():
            slot = self.slots[member] - first
            pose = Transformation3d()
            pose.set_pose(*self.mountings[member].carried(positions[row, slot].tolist(), rotations[row, slot].tolist()))
            position, wxyz = self._one(member, pose)
            turned = quaternion(wxyz) or {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0}
            numbers = [*position, turned["x"], turned["y"], turned["z"], turned["w"]]
            begin = int(rows.begins[row] + self._places[member])
            rows.chunk[begin : begin + POSE] = np.array(numbers, dtype=_SEVEN).view(np.uint8)

    def _encoded(self, rows: Rows, poses: Poses) -> NDArray[np.uint8]:
        """Encode with the kernel; returns (R, N) 1 for each message that is left to Python."""
        raise NotImplementedError

    def _one(self, member: int, pose: Transformation3d) -> tuple[Sequence[float], Sequence[float]]:
        """Return position and quaternion w, x, y, z of a message, in Python."""
        raise NotImplementedError
