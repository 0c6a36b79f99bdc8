"""What a recording says about the world at a moment: poses, appearance, and who was there."""

from __future__ import annotations

import bisect
import json
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from morse.recording.errors import RecordingError
from morse.recording.history import History
from morse.recording.motion import LOOKS, NODES, POSES, TEXT_TYPE
from morse.rosmsgs.cdr import CdrError, decode

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from morse.recording.recording import Recording

#: maximum length of a name in a message
_LONGEST = 1000
#: size of a pose, bytes
_POSE = 56
#: size of a message before its first pose, and of one without poses, bytes
_HEAD, _EMPTY = 28, 24


class Moment(NamedTuple):
    """The world at the end of a tick.

    Attributes:
        tick: its number, counted since the last reset of the run.
        names: (M) names of the moving nodes.
        poses: (M, 7) x, y, z (m) and quaternion w, x, y, z, in the world.
    """

    tick: int
    names: tuple[str, ...]
    poses: NDArray[np.float64]


class RecordedWorld:
    """The poses and the appearance in a recording.

    Args:
        recording: the recording.

    Attributes:
        history: the messages.
    """

    def __init__(self, recording: Recording) -> None:
        self.history = History(recording)
        self._path = recording.path
        numbers = {channel.topic: channel.number for channel in recording.channels.values()}
        self._poses, self._nodes, self._looks = (numbers.get(topic, -1) for topic in (POSES, NODES, LOOKS))
        self._names = self._texts(self._nodes)
        self._changes = self._texts(self._looks)
        self._name_times = [time for time, _ in self._names]
        self._change_times = [time for time, _ in self._changes]
        for _, names in self._names:
            if not isinstance(names, list) or not all(isinstance(name, str) and len(name) < _LONGEST for name in names):
                raise RecordingError(f"{self._path}: the names of the nodes are damaged")

    @staticmethod
    def is_in(recording: Recording) -> bool:
        """Whether a recording has the poses of the nodes; those of earlier versions have not."""
        return bool(recording.topic_numbers(POSES)) and bool(recording.topic_numbers(NODES))

    def _texts(self, channel: int) -> list[tuple[int, Any]]:
        try:
            return [
                (one.log_time, json.loads(decode(TEXT_TYPE, one.data)["data"]))
                for one in (self.history.every(channel) if channel >= 0 else ())
            ]
        except (CdrError, ValueError, LookupError, TypeError, RecursionError) as error:
            raise RecordingError(f"{self._path}: the description of the nodes is damaged: {error}") from None

    def at(self, time: int) -> Moment | None:
        """The world at a log time, ns; None before the first tick.

        Raises:
            RecordingError: the file is damaged.
        """
        message = self.history.last(self._poses, time)
        if message is None:
            return None
        # names are written before the poses of the same tick
        index = bisect.bisect_right(self._name_times, message.log_time) - 1
        names = self._names[index][1] if index >= 0 else []
        count = len(names)
        numbers = np.frombuffer(message.data, dtype=np.uint8)
        # with a fixed frame, all messages of as many poses have one length
        if len(numbers) != (_HEAD + _POSE * count if count else _EMPTY):
            raise self._damaged(message.sequence)
        poses = numbers[_HEAD:].view("<f8").reshape(count, 7) if count else np.empty((0, 7))
        if not np.isfinite(poses).all():
            raise self._damaged(message.sequence)
        return Moment(message.sequence, tuple(names), poses[:, [0, 1, 2, 6, 3, 4, 5]])

    def _damaged(self, tick: int) -> RecordingError:
        return RecordingError(f"{self._path}: the poses of tick {tick} are damaged")

    def looks(self, begin: int, end: int) -> list[Any]:
        """The changes of appearance with begin < log time <= end, ns, in order."""
        first, last = (bisect.bisect_right(self._change_times, time) for time in (begin, end))
        return [change for _, changes in self._changes[first:last] if isinstance(changes, list) for change in changes]
