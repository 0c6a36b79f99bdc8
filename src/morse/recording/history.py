"""The messages of a recording by channel and time, read on demand."""

from __future__ import annotations

import bisect
from collections import OrderedDict
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from morse.recording.mcap.reader import Chunk, McapFile
    from morse.recording.mcap.records import Message

#: number of chunks that are kept in memory
_MOST_KEPT = 6


class _Series(NamedTuple):
    times: list[int]
    messages: list[Message]


class History:
    """Finds messages; the latest chunks are kept in memory.

    Args:
        file: an MCAP file.
    """

    def __init__(self, file: McapFile) -> None:
        self._file = file
        self._cache: OrderedDict[int, dict[int, _Series]] = OrderedDict()
        self._starts = [chunk.start for chunk in file.chunks]

    def _series(self, chunk: Chunk) -> dict[int, _Series]:
        present = self._cache.get(chunk.offset)
        if present is None:
            present = {}
            for one in self._file.messages_of(chunk):
                series = present.setdefault(one.channel, _Series([], []))
                series.times.append(one.log_time)
                series.messages.append(one)
            self._cache[chunk.offset] = present
            if len(self._cache) > _MOST_KEPT:
                self._cache.popitem(last=False)
        self._cache.move_to_end(chunk.offset)
        return present

    def last(self, channel: int, until: int) -> Message | None:
        """The last message of a channel whose log time is not later than ``until``, ns; None if there is none.

        Raises:
            RecordingError: a chunk is damaged.
        """
        # log time never decreases
        for chunk in reversed(self._file.chunks[: bisect.bisect_right(self._starts, until)]):
            if not chunk.may_hold(channel):
                continue
            series = self._series(chunk).get(channel)
            index = 0 if series is None else bisect.bisect_right(series.times, until)
            if series is not None and index:
                return series.messages[index - 1]
        return None

    def every(self, channel: int) -> list[Message]:
        """All messages of a channel.

        Raises:
            RecordingError: a chunk is damaged.
        """
        return list(self._file.messages((channel,)))
