"""The positions of the messages of a chunk."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple, TypeAlias

from morse.recording.mcap import records

if TYPE_CHECKING:
    from collections.abc import Mapping

    import numpy as np
    from numpy.typing import NDArray

#: log time (ns) and offset in the chunk of messages of a channel, (N, 2), in the order of the offsets
Entries: TypeAlias = "NDArray[np.int64]"


class ChunkIndex(NamedTuple):
    """The records ``MessageIndex`` that follow a chunk.

    Attributes:
        start, end: first and last log time, ns; log time never decreases.
        records: the records, as bytes.
        places: offset of the record of each channel.
        counts: number of messages of each channel.
    """

    start: int
    end: int
    records: bytes | memoryview
    places: Mapping[int, int]
    counts: Mapping[int, int]


def index_of(entries: Mapping[int, Entries]) -> ChunkIndex:
    """Return the index of messages by channel."""
    made, places, place = [], {}, 0
    for number, each in entries.items():
        made.append(records.message_index(number, each))
        places[number] = place
        place += len(made[-1])
    start = min(int(each[0, 0]) for each in entries.values())
    end = max(int(each[-1, 0]) for each in entries.values())
    return ChunkIndex(start, end, b"".join(made), places, {number: len(each) for number, each in entries.items()})
