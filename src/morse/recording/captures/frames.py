"""Simulated time and the frames of robots."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from morse.helpers.transformation import Transformation3d
from morse.recording.captures.poses import POSE, PosesCapture
from morse.rosmsgs.poses import quaternion_of

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray

    from morse.kernel.recording import Batch, NativeRecords, Poses, Rows
    from morse.recording.captures.poses import Read
    from morse.recording.captures.template import Template
    from morse.rosmsgs.moving import MovingFrame

_NO_TURN = Transformation3d()


class FramesCapture(PosesCapture):
    """``rosgraph_msgs/Clock``, and ``tf2_msgs/TFMessage`` with the base of each robot, and its joints.

    Args:
        native: the encoder.
        template: both messages; without frames only the first one.
        ends: end of each transform in the second message.
        frames: the frame of each transform.
    """

    def __init__(
        self, native: NativeRecords, template: Template, ends: Sequence[int], frames: Sequence[MovingFrame]
    ) -> None:
        places = template.begins[-1] + np.array(ends, dtype=np.int64) - POSE
        objects = [frame.object for frame in frames]
        super().__init__(native, template, places, [one.slot for one in objects], [one.mounting for one in objects])
        self._frames = frames
        starts = [frame.start or _NO_TURN for frame in frames]
        numbers = [[*position, *rotation] for position, rotation in (start.get_pose() for start in starts)]
        self._origins = np.array(numbers, dtype=np.float64).reshape(-1, 12)
        self._parents = np.array([-1 if one.against is None else one.against.slot for one in frames], dtype=np.int64)
        #: the poses of the parents are needed, too
        self.slots = [*self.slots, *(slot for slot in self._parents.tolist() if slot >= 0)]

    def _encoded(self, batch: Batch, rows: Rows, poses: Poses, mend: Callable[[NDArray[np.uint8]], object]) -> None:
        batch.frames(rows, poses, self._origins, self._parents, mend)

    def _one(self, member: int, pose: Transformation3d, read: Read) -> tuple[Sequence[float], Sequence[float]]:
        frame = self._frames[member]
        parent = frame.start
        if parent is None:
            parent = Transformation3d()
            parent.set_pose(*read(int(self._parents[member])))
        moved = parent.transformation3d_with(pose)
        return (moved.x, moved.y, moved.z), quaternion_of(moved)
