"""Simulated time, frames and poses of nodes in many ticks, from the poses of the engine."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from morse.mathutils.rotation_rows import quaternions_from_rotations
from morse.mathutils.rotations import product, turn_back
from morse.recording.fields.messages import Batch
from morse.rosmsgs.cdr import encode_rows
from morse.rosmsgs.names import MAP
from morse.rosmsgs.parts import header_at, time, xyzw

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from morse.core.values import Fields
    from morse.physics.poses.pose_rows import Numbers, PoseRows
    from morse.rosmsgs.moving import MovingFrame

CLOCK_TYPE, FRAMES_TYPE, POSES_TYPE = "rosgraph_msgs/msg/Clock", "tf2_msgs/msg/TFMessage", "geometry_msgs/msg/PoseArray"


class Channels(NamedTuple):
    """Channels in the file; -1 if a topic is not in the file."""

    clock: int
    frames: int
    poses: int


class World(NamedTuple):
    """What is written of the poses, while it stays the same.

    Attributes:
        channels: of the messages.
        nodes: number of the nodes in the list of poses; these are the first objects.
        slots: rigid group of each object.
        frames: names of the frames, parent and child, or None if they are not made of poses.
        starts: (F, 12) poses of the parents of the first frames, m; the objects of these frames follow the nodes. For
            each other frame there are two objects: that of the frame and that of its parent.
    """

    channels: Channels
    nodes: int
    slots: NDArray[np.intp]
    frames: Sequence[tuple[str, str]] | None
    starts: NDArray[np.float64]

    def of(self, ticks: NDArray[np.int64], stamps: NDArray[np.int64], rows: PoseRows) -> list[Batch]:
        """Encode the messages of some ticks.

        Args:
            ticks: (R,) their numbers.
            stamps: (R,) simulated times, ns.
            rows: the poses of the engine.
        """
        count = len(ticks)
        batches = [Batch(self.channels.clock, ticks, encode_rows(CLOCK_TYPE, {"clock": time(stamps)}, count))]
        positions, rotations = rows.carried(self.slots)
        if self.frames:
            transforms = self._transforms(stamps, positions, rotations)
            batches.append(
                Batch(self.channels.frames, ticks, encode_rows(FRAMES_TYPE, {"transforms": transforms}, count))
            )
        # a sum with zero removes the sign of zero, as the product with the pose of the world
        nodes = [numbers[:, : self.nodes] + 0.0 for numbers in (*positions, *rotations)]
        poses = [
            {"position": _named("xyz", place), "orientation": _named("xyzw", quaternion)}
            for place, quaternion in zip(_each(nodes[:3]), _each(_quaternions(nodes[3:])), strict=True)
        ]
        message = {"header": header_at(stamps, MAP), "poses": poses}
        return [*batches, Batch(self.channels.poses, ticks, encode_rows(POSES_TYPE, message, count))]

    def _transforms(self, stamps: NDArray[np.int64], positions: Numbers, rotations: Numbers) -> list[Fields]:
        assert self.frames is not None
        first, bases, others = self.nodes, len(self.starts), len(self.frames) - len(self.starts)
        children = slice(first, first + bases + others)
        above = slice(first + bases + others, None)
        starts = np.broadcast_to(self.starts.T[:, None, :], (12, len(stamps), bases))
        parents = [np.concatenate((start, numbers[:, above]), axis=1)
                   for start, numbers in zip(starts, (*positions, *rotations), strict=True)]  # fmt: skip
        place, m = parents[:3], parents[3:]
        offsets = turn_back(m, [q[:, children] - p for p, q in zip(place, positions, strict=True)])  # type: ignore[arg-type]
        back = m[0], m[3], m[6], m[1], m[4], m[7], m[2], m[5], m[8]
        turns = product(back, tuple(numbers[:, children] for numbers in rotations))  # type: ignore[arg-type]
        pairs = zip(self.frames, _each(offsets), _each(_quaternions(turns)), strict=True)  # type: ignore[arg-type]
        return [
            {
                "header": header_at(stamps, parent),
                "child_frame_id": child,
                "transform": {"translation": _named("xyz", place), "rotation": _named("xyzw", turn)},
            }
            for (parent, child), place, turn in pairs
        ]


def world_of(
    channels: Channels, nodes: Sequence[object], frames: Sequence[MovingFrame] | None
) -> tuple[World, list[object]]:
    """Return what is written, and the objects whose mountings are needed."""
    bases = [frame for frame in frames or () if frame.start is not None]
    others = [frame for frame in frames or () if frame.start is None]
    objects = [*nodes, *(one.object for one in (*bases, *others)), *(one.against for one in others)]
    numbers = [[*position, *rotation] for position, rotation in (one.start.get_pose() for one in bases if one.start)]
    names = None if frames is None else [(one.parent, one.child) for one in (*bases, *others)]
    slots = np.array([one.slot for one in objects], dtype=np.intp)
    return World(channels, len(nodes), slots, names, np.array(numbers, dtype=np.float64).reshape(-1, 12)), objects


def _quaternions(rotations: Numbers) -> Numbers:
    """Quaternions x, y, z, w, as messages have them."""
    shape = rotations[0].shape
    quaternions = quaternions_from_rotations([numbers.reshape(-1) for numbers in rotations])
    return [np.broadcast_to(part, quaternions[0].shape).reshape(shape) for part in xyzw(np.stack(quaternions, axis=-1))]  # type: ignore[arg-type]


def _each(numbers: Numbers) -> list[list[NDArray[np.float64]]]:
    """The numbers (R,) of each object."""
    return [[part[:, column] for part in numbers] for column in range(numbers[0].shape[1])]


def _named(axes: str, numbers: Sequence[NDArray[np.float64]]) -> Fields:
    return dict(zip(axes, numbers, strict=True))
