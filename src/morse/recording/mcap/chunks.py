"""Puts the messages of a chunk into the order of their times, and makes their index."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from morse.recording.mcap.index import ChunkIndex, index_of
from morse.recording.mcap.records import MESSAGE, MESSAGE_FIXED, MESSAGE_HEAD

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from morse.recording.mcap.index import Entries

#: the begin of a message: opcode, size, channel, sequence, log time, publish time
_HEAD = np.dtype([("opcode", "u1"), ("size", "<u8"), ("channel", "<u2"), ("sequence", "<u4"), ("log", "<u8"),
                  ("publish", "<u8")])  # fmt: skip
assert _HEAD.itemsize == MESSAGE_HEAD.size


class Messages(NamedTuple):
    """Messages of one channel.

    Attributes:
        channel: its id.
        moments: (R, 3) number of ticks (32 bits), log time and simulated time, ns, of each.
        data: (R, size) messages of one size, or R messages.
    """

    channel: int
    moments: NDArray[np.int64]
    data: NDArray[np.uint8] | Sequence[bytes]


def chunk_of(messages: Sequence[Messages]) -> tuple[NDArray[np.uint8], ChunkIndex]:
    """Return the records of messages as bytes, and their index.

    Messages of the same time stay in the given order.
    """
    sizes = np.concatenate([_sizes(one) for one in messages]) + MESSAGE_HEAD.size
    order = np.argsort(np.concatenate([one.moments[:, 1] for one in messages]), kind="stable")
    begins = np.empty(len(sizes), dtype=np.int64)
    ends = np.cumsum(sizes[order])
    begins[order] = ends - sizes[order]
    chunk = np.empty(int(ends[-1]), dtype=np.uint8)
    places: dict[int, list[Entries]] = {}
    first = 0
    for one in messages:
        at = begins[first : first + len(one.moments)]
        first += len(one.moments)
        if isinstance(one.data, np.ndarray):
            _put_rows(chunk, at, one, one.data)
        else:
            _put_each(chunk, at, one, one.data)
        places.setdefault(one.channel, []).append(np.stack((one.moments[:, 1], at), axis=1))
    return chunk, index_of({channel: _in_order(parts) for channel, parts in places.items()})


def _sizes(one: Messages) -> NDArray[np.int64]:
    if isinstance(one.data, np.ndarray):
        return np.full(len(one.data), one.data.shape[1], dtype=np.int64)
    return np.array([len(data) for data in one.data], dtype=np.int64)


def _heads(one: Messages, sizes: NDArray[np.int64]) -> NDArray[np.void]:
    heads = np.empty(len(one.moments), dtype=_HEAD)
    heads["opcode"], heads["size"], heads["channel"] = MESSAGE, sizes + MESSAGE_FIXED, one.channel
    heads["sequence"], heads["log"], heads["publish"] = one.moments.T
    return heads


def _put_rows(chunk: NDArray[np.uint8], begins: NDArray[np.int64], one: Messages, data: NDArray[np.uint8]) -> None:
    head = _HEAD.itemsize
    records = np.empty((len(data), head + data.shape[1]), dtype=np.uint8)
    records[:, :head] = _heads(one, _sizes(one)).view(np.uint8).reshape(-1, head)
    records[:, head:] = data
    size = records.shape[1]
    # each place of the chunk at which a record may begin
    windows = np.ndarray((len(chunk) - size + 1,), dtype=f"V{size}", buffer=chunk, strides=(1,))
    windows[begins] = records.view(f"V{size}")[:, 0]


def _put_each(chunk: NDArray[np.uint8], begins: NDArray[np.int64], one: Messages, data: Sequence[bytes]) -> None:
    view = chunk.data
    for head, begin, message in zip(_heads(one, _sizes(one)), begins.tolist(), data, strict=True):
        at = begin + _HEAD.itemsize
        view[begin:at] = head.tobytes()
        view[at : at + len(message)] = message


def _in_order(parts: list[Entries]) -> Entries:
    if len(parts) == 1:
        return parts[0]
    entries = np.concatenate(parts)
    return entries[np.argsort(entries[:, 1], kind="stable")]
