"""The poses of all moving nodes."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from morse.helpers.transformation import Transformation3d
from morse.recording.captures.poses import POSE, PosesCapture, groups_of
from morse.recording.mcap.records import MESSAGE_HEAD
from morse.rosmsgs.poses import quaternion_of

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray

    from morse.kernel.recording import Batch, NativeRecords, Poses, Rows
    from morse.physics.poses.snapshot import Snapshot
    from morse.recording.captures.poses import Read
    from morse.recording.captures.template import Template


class NodesCapture(PosesCapture):
    """``geometry_msgs/PoseArray`` with the poses of all moving nodes in the world.

    Args:
        native: the encoder.
        template: the message.
        snapshot: poses of the nodes.
    """

    def __init__(self, native: NativeRecords, template: Template, snapshot: Snapshot) -> None:
        count = len(snapshot.slots)
        places = len(template.bytes) - POSE * np.arange(count, 0, -1, dtype=np.int64)
        super().__init__(native, template, places, snapshot.slots, snapshot.mountings)
        self._origin = Transformation3d()
        self._origins = np.tile(np.append(np.zeros(3), np.eye(3)), (count, 1))
        self._parents = np.full(count, -1, dtype=np.int64)

    def message(self, stamp: int, snapshot: Snapshot) -> bytes:
        """Return the message of the present poses.

        Args:
            stamp: simulated time, ns.
            snapshot: the present poses of the same nodes.
        """
        chunk = np.empty(self.size, dtype=np.uint8)
        begins, moments = np.zeros(1, dtype=np.int64), np.array([[0, stamp, stamp]], dtype=np.int64)
        batch = self._native.batch()
        self.encode(batch, begins, moments, groups_of(snapshot), chunk)
        batch.run()
        return chunk[MESSAGE_HEAD.size :].tobytes()

    def _encoded(self, batch: Batch, rows: Rows, poses: Poses, mend: Callable[[NDArray[np.uint8]], object]) -> None:
        batch.frames(rows, poses, self._origins, self._parents, mend)

    def _one(self, member: int, pose: Transformation3d, read: Read) -> tuple[Sequence[float], Sequence[float]]:
        moved = self._origin.transformation3d_with(pose)
        return (moved.x, moved.y, moved.z), quaternion_of(moved)
