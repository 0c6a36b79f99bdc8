"""The data for observers at the end of a tick."""

from __future__ import annotations

import struct
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from morse.scene import Node

POSES = 1
"""The first word of a binary frame with poses."""

_KIND = struct.Struct("<I")
HEADER = struct.Struct("<IIIIddff")
"""kind, revision of the scene, number of poses, 1 while running, tick, time (s), speed, real-time factor."""


@dataclass(frozen=True, slots=True)
class MovingNode:
    """A node whose pose changes while the simulation runs.

    Attributes:
        frame: ``world``: its poses are in the world frame, independent of its parent in the scene;
            ``parent``: they are in the rigid frame of its parent.
    """

    node: Node
    frame: Literal["world", "parent"] = "world"


@dataclass(frozen=True, slots=True)
class Snapshot:
    """The world at the end of a tick.

    Attributes:
        tick: number of ticks since the start.
        time: simulated seconds.
        layout: increased by one whenever the list of moving nodes changes.
        poses: (M, 7) float32 of x, y, z (m), qw, qx, qy, qz, in the order of the moving nodes.
        status: whether simulated time advances.
        speed: requested simulated seconds per wall-clock second; ``inf``: as fast as possible.
        real_time_factor: reached simulated seconds per wall-clock second.
    """

    tick: int
    time: float
    layout: int
    poses: NDArray[np.float32]
    status: Literal["running", "paused"] = "running"
    speed: float = 1.0
    real_time_factor: float = 1.0


def holds_poses(frame: str | bytes) -> bool:
    """Whether a frame that a page has received is a snapshot, not a message."""
    return isinstance(frame, bytes) and _KIND.unpack_from(frame)[0] == POSES


def pack_snapshot(snapshot: Snapshot, revision: int) -> bytes:
    """The binary frame that pages receive: `HEADER`, then the poses as little-endian float32."""
    header = HEADER.pack(
        POSES,
        revision,
        len(snapshot.poses),
        snapshot.status == "running",
        snapshot.tick,
        snapshot.time,
        snapshot.speed,
        snapshot.real_time_factor,
    )
    return header + snapshot.poses.astype("<f4", copy=False).tobytes()
