"""Keeps the poses of the engine in each tick."""

from __future__ import annotations

from bisect import bisect_right
from itertools import groupby
from typing import TYPE_CHECKING, Any

import numpy as np

from morse.physics.poses.pose_rows import PoseRows
from morse.recording.fields.poses import Channels, World, world_of

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from numpy.typing import NDArray

    from morse.core.context import Context
    from morse.recording.fields.messages import Batch
    from morse.recording.motion import Motion
    from morse.recording.streams import Tape
    from morse.rosmsgs.topics.transforms import Transforms

#: number of values of a tick in the flat list
_STRIDE = 5


class KeptPoses:
    """Keeps the poses of all rigid groups; simulated time, frames and poses of nodes follow from them.

    Args:
        context: of the simulation.
        tape: receives messages when the nodes have changed.
        transforms: the tree of frames.
        motion: names the nodes, and publishes changes of their appearance.
        clock, frames: ids of the channels of time and frames.

    Attributes:
        has_frames: whether all frames follow from poses.
    """

    def __init__(
        self, context: Context, tape: Tape, transforms: Transforms, motion: Motion, clock: int, frames: int
    ) -> None:
        self._clock, self._world, self._tape = context.clock, context.world, tape
        self._transforms, self.motion = transforms, motion
        self._channels = Channels(clock, frames, motion.channel)
        self.has_frames = False
        self._rows: list[Any] = []
        self.follow()

    def follow(self) -> None:
        """The objects may have changed."""
        self._displacements = self._layout = -1
        self._mountings: list[object] = []
        self._objects: list[Any] = []
        self._world_so_far: World | None = None

    def keep(self) -> bool:
        """Keep the poses of the present tick; return False if the frames or the nodes have changed."""
        world, is_same = self._world, True
        if self._transforms.changed or world.layout != self._layout or self._world_so_far is None:
            self._renew()
            is_same = False
        if world.displacements != self._displacements:
            self._displacements = world.displacements
            mountings = [obj.mounting for obj in self._objects]
            # most objects that are moved are none of these, such as the bones of an arm
            if mountings != self._mountings:
                self._mountings = mountings
        positions, rotations = world.positions, world.rotations
        self._rows += (self._clock.tick, self._world_so_far, self._mountings, positions.share(), rotations.share())
        self._tape.held += 96 * len(positions)
        return is_same

    def _renew(self) -> None:
        world, stamp = self._world, self._clock.stamp()
        if self._transforms.changed:
            # only the fixed frames are sent, and the moving ones found
            self._transforms.publish(stamp, wanted=False)
        nodes = self.motion.renew()
        self._layout = world.layout
        frames = self._transforms.plain()
        self.has_frames = frames is not None
        self._world_so_far, self._objects = world_of(self._channels, nodes, frames)
        self._displacements = -1

    def batches(self, until: int, times: Callable[[NDArray[np.int64]], NDArray[np.int64]]) -> Iterator[Batch]:
        """See `RecordedStream.batches`."""
        some = self._rows[:]
        count = bisect_right(some[::_STRIDE], until)
        del self._rows[: _STRIDE * count]
        numbers, *columns = (some[k : _STRIDE * count : _STRIDE] for k in range(_STRIDE))
        every = np.array(numbers, dtype=np.int64)
        # compared without a function of Python for each tick: the simulation would wait for it
        keys = list(zip(map(id, columns[0]), map(len, columns[2]), strict=True))
        for _, group in groupby(range(count), keys.__getitem__):
            places = list(group)
            part = slice(places[0], places[-1] + 1)
            worlds, mountings, positions, rotations = (column[part] for column in columns)
            poses = PoseRows.of(positions, rotations, mountings)
            yield from worlds[0].of(every[part], self._clock.stamps_of(every[part]), poses)
