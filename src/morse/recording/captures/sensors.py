"""Captures of sensors that act together."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from morse.core.kinds.turning import quaternion_of
from morse.kernel.memory import address
from morse.kernel.recording import Scans
from morse.recording.captures.capture import Capture
from morse.recording.captures.lone import Lone
from morse.recording.captures.poses import POSE, PosesCapture

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray

    from morse.core.groups.group import Group
    from morse.helpers.transformation import Transformation3d
    from morse.kernel.recording import Batch, NativeRecords, Poses, Rows
    from morse.physics.poses.snapshot import Snapshot
    from morse.physics.rays.bundle import RayBundle
    from morse.recording.captures.poses import Read
    from morse.recording.captures.template import Template


class PoseSensors(PosesCapture):
    """``geometry_msgs/PoseStamped`` of sensors of the class `Pose`.

    Args:
        native: the encoder.
        template: the message of each sensor.
        snapshot: the poses of a group.
        members: rows of the sensors in the group.
    """

    def __init__(self, native: NativeRecords, template: Template, snapshot: Snapshot, members: Sequence[int]) -> None:
        # the numbers are at the end of each message
        places = np.append(template.heads[1:], len(template.bytes)) - POSE
        slots, mountings = ([of[row] for row in members] for of in (snapshot.slots, snapshot.mountings))
        super().__init__(native, template, places, slots, mountings)  # type: ignore[arg-type]

    def _encoded(self, batch: Batch, rows: Rows, poses: Poses, mend: Callable[[NDArray[np.uint8]], object]) -> None:
        batch.poses(rows, poses, mend)

    def _one(self, member: int, pose: Transformation3d, read: Read) -> tuple[Sequence[float], Sequence[float]]:
        x, y, z, yaw, pitch, roll = pose.numbers()
        # fields are added to an offset of zero, which removes the sign of zero
        return (x + 0.0, y + 0.0, z + 0.0), quaternion_of(roll, pitch, yaw)


class Scanners(Capture):
    """``sensor_msgs/LaserScan`` of laser scanners with equal fans.

    The stored data of R ticks are R arrays of distances (B, rays), m.

    Args:
        native: the encoder.
        template: the message of each scanner.
        bundles: rays of all scanners of the group.
        members: rows of the recorded scanners.
        kept: number of rays of each scan that are in its message.
        reach: distance that means no hit, m.
    """

    is_taken = True

    def __init__(
        self,
        native: NativeRecords,
        template: Template,
        bundles: Sequence[RayBundle],
        members: Sequence[int],
        kept: int,
        reach: float,
    ) -> None:
        super().__init__(native, template)
        self.held = 8 * len(bundles) * len(bundles[0])
        self._directions, self._reach, self._kept = bundles[0].directions, bundles[0].reach, kept
        self._members = np.array(members, dtype=np.int64)
        self._reaches = np.full(len(members), reach)
        # the distances, and the length 0 of intensities, are at the end of each message
        self._places: NDArray[np.int64] = np.append(template.heads[1:], self.size) - 4 * kept - 4

    def take(self, group: Group | Lone) -> NDArray[np.float64] | None:
        """The distances (B, rays) of a tick; None if the scans were made in several casts, or if a fan has changed."""
        scanners: Any = group.members
        if isinstance(group, Lone):
            sight = scanners[0].rays.sight
            first, sights = sight.row, [sight]
        else:
            # their scanners are no longer in the cache of the processor
            first, sights = 0, group.memory["sights"]
        scan = sights[0].scan
        if scan.directions is not self._directions or scan.reach != self._reach:
            return None
        for row, sight in enumerate(sights, first):
            if sight.scan is not scan or sight.row != row:
                return None
        distances: NDArray[np.float64] = scan.distances
        return distances[first : first + 1] if isinstance(group, Lone) else distances

    def _fill(self, batch: Batch, rows: Rows, data: Any) -> None:
        places = np.array([address(distances) for distances in data], dtype=np.int64)
        rays = data[0].shape[1]
        scans = Scans(places, self._members, rays, self._kept, self._reaches, self._places)
        batch.scans(rows, scans)
