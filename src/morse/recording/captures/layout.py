"""The stored data of one tick."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from morse.recording.captures.lone import Lone
from morse.recording.captures.poses import PosesCapture
from morse.recording.captures.sensors import PoseSensors

if TYPE_CHECKING:
    from collections.abc import Sequence

    from morse.core.groups.group import Group
    from morse.recording.captures.capture import Capture

#: size of a position and a rotation, bytes
_POSE = 96
#: approximate memory of the objects of Python of a tick, bytes
_OBJECTS = 300


class Layout:
    """The records of a tick in which certain groups of sensors have measured.

    Args:
        groups: groups of sensors.
        captures: the capture of each group.
        others: captures that do not belong to sensors.

    Attributes:
        offsets: offset of the records of each capture.
        size: size of all records, bytes.
        held: approximate memory of a tick until it is encoded, bytes.
        posed: groups whose poses are stored.
        alone: sensors that act alone, and whose poses are stored.
        taken: groups whose data are stored, and their captures.
        first, last: the rigid groups whose poses are needed: ``range(first, last)``.
    """

    def __init__(self, groups: Sequence[Group | Lone], captures: Sequence[Capture], others: Sequence[Capture]) -> None:
        self.offsets: dict[Capture, int] = {}
        self.size, self.held = 0, _OBJECTS
        for capture in (*captures, *others):
            self.offsets[capture] = self.size
            self.size += capture.size
            self.held += capture.size + capture.held
        pairs = list(zip(groups, captures, strict=True))
        posed = [group for group, capture in pairs if isinstance(capture, PoseSensors)]
        self.posed = [group for group in posed if not isinstance(group, Lone)]
        self.alone = [sensor for sensor in posed if isinstance(sensor, Lone)]
        self.taken: list[tuple[Group | Lone, Any]] = [(group, capture) for group, capture in pairs if capture.is_taken]
        slots = [slot for capture in self.offsets if isinstance(capture, PosesCapture) for slot in capture.slots]
        self.first, self.last = min(slots, default=0), max(slots, default=-1) + 1
        self._held = self.held

    def store(self, groups: int) -> None:
        """Set the number of rigid groups whose poses are stored."""
        self.held = self._held + _POSE * groups
