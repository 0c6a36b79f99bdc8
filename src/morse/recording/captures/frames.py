"""Simulated time and the frames of robots."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from morse.middleware.ros2.poses import quaternion_of
from morse.recording.captures.poses import POSE, PosesCapture

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray

    from morse.helpers.transformation import Transformation3d
    from morse.kernel.recording import Batch, NativeRecords, Poses, Rows
    from morse.physics.snapshot import Snapshot
    from morse.recording.captures.template import Template


class FramesCapture(PosesCapture):
    """``rosgraph_msgs/Clock``, and ``tf2_msgs/TFMessage`` with the base of each robot relative to its initial pose.

    Args:
        native: the encoder.
        template: both messages; without robots only the first one.
        ends: end of the transform of each robot in the second message.
        starts: initial pose of each robot.
        snapshot: poses of the robots.
    """

    def __init__(
        self,
        native: NativeRecords,
        template: Template,
        ends: Sequence[int],
        starts: Sequence[Transformation3d],
        snapshot: Snapshot,
    ) -> None:
        places = template.begins[-1] + np.array(ends, dtype=np.int64) - POSE
        super().__init__(native, template, places, snapshot.slots, snapshot.mountings)
        self._starts = starts
        numbers = [[*position, *rotation] for position, rotation in (start.get_pose() for start in starts)]
        self._origins = np.array(numbers, dtype=np.float64).reshape(-1, 12)

    def _encoded(self, batch: Batch, rows: Rows, poses: Poses, mend: Callable[[NDArray[np.uint8]], object]) -> None:
        batch.frames(rows, poses, self._origins, mend)

    def _one(self, member: int, pose: Transformation3d) -> tuple[Sequence[float], Sequence[float]]:
        moved = self._starts[member].transformation3d_with(pose)
        return (moved.x, moved.y, moved.z), quaternion_of(moved)
