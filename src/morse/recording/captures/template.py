"""The records of one tick, whose times and numbers are replaced."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from morse.recording.mcap import records
from morse.recording.mcap.records import MESSAGE_HEAD, Message

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from numpy.typing import NDArray

#: offset of the time stamp in a message that begins with a header or a time: after the CDR header
STAMP = 4


class Part(NamedTuple):
    """One record of a template.

    Attributes:
        channel: id of its channel.
        data: the message in CDR.
        stamps: offsets of time stamps in the message.
    """

    channel: int
    data: bytes
    stamps: Sequence[int] = (STAMP,)


class Template:
    """Concatenated records.

    Attributes:
        bytes: (size,) the records.
        channels, numbers: (H,) channel of each record, as a list and an array.
        heads: (H,) offset of each record.
        begins: (H,) offset of each message.
        stamps: (S,) offset of each time stamp.
        spans: offset, length and distance of similar bytes, see `morse.kernel.recording.Similar`: messages of equal
            length resemble the message before, others those of the tick before.
    """

    def __init__(self, parts: Iterable[Part]) -> None:
        made, heads, stamps, at = [], [], [], 0
        self.channels: list[int] = []
        for part in parts:
            heads.append(at)
            stamps += [at + MESSAGE_HEAD.size + place for place in part.stamps]
            self.channels.append(part.channel)
            made.append(records.message(Message(part.channel, 0, 0, 0, part.data)))
            at += len(made[-1])
        self.bytes: NDArray[np.uint8] = np.frombuffer(bytearray().join(made), dtype=np.uint8)
        self.heads = np.array(heads, dtype=np.int64)
        self.numbers = np.array(self.channels, dtype=np.int64)
        self.begins = self.heads + MESSAGE_HEAD.size
        self.stamps = np.array(stamps, dtype=np.int64)
        self.spans = [(0, at, 0)]
        lengths = set(map(len, made))
        if len(made) > 1 and len(lengths) == 1:
            (length,) = lengths
            self.spans = [(0, length, 0), (length, at - length, length)]
