"""Records that C compresses and indexes are what the library of Zstandard and the writer in Python make of them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pytest
import zstandard

from morse.kernel.recording import NativeRecords, Similar
from morse.recording.mcap.records import message_index

if TYPE_CHECKING:
    import ctypes

_BLOCK = 1 << 17
_AFTER = b"bytes that follow the frame"


def integers(values: object) -> np.ndarray:
    return np.array(values, dtype=np.int64)


def packed(native: NativeRecords, plain: np.ndarray, similar: Similar) -> bytes:
    frame = np.zeros(5 * len(plain) // 4 + 1024 + len(_AFTER), dtype=np.uint8)
    batch = native.batch()
    size = batch.pack(plain, similar, frame, np.frombuffer(_AFTER, dtype=np.uint8))
    batch.run()
    assert frame[size() : size() + len(_AFTER)].tobytes() == _AFTER
    return frame[: size()].tobytes()


def similar_of(ticks: int, size: int, spans: list[tuple[int, int, int, int]], first: int = 0) -> Similar:
    begins = first + size * np.arange(ticks)
    return Similar(begins, integers([0] * ticks), integers([0, len(spans)]), integers(spans), len(spans))


@pytest.mark.parametrize("seed", range(12))
def test_what_is_packed_is_unpacked(build: ctypes.CDLL, seed: int) -> None:
    native, rng = NativeRecords(build), np.random.default_rng(seed)
    size, ticks = int(rng.integers(20, 3000)), int(rng.integers(1, 300))
    plain = np.tile(rng.integers(0, 256, size, dtype=np.uint8), (ticks, 1))
    # from hardly any different bytes to only different ones
    different = rng.random(plain.shape) < (0.001, 0.02, 0.2, 1.0)[seed % 4]
    plain[different] = rng.integers(0, 256, int(different.sum()), dtype=np.uint8)
    cuts = [0, *sorted(rng.choice(np.arange(1, size), 3, replace=False).tolist()), size]
    distances = (0, int(rng.integers(1, size)), 0, int(rng.integers(1, 40)))
    spans = [
        (begin, end - begin, distance, column)
        for column, (begin, end, distance) in enumerate(zip(cuts, cuts[1:], distances, strict=False))
    ]
    # with other records before the ticks, and after them
    whole = np.concatenate((plain[0, :10], plain.ravel(), plain[0]))
    frame = packed(native, whole, similar_of(ticks, size, spans[seed % 2 :], 10))
    assert zstandard.ZstdDecompressor().decompress(frame) == whole.tobytes()


def test_equal_ticks_take_no_room(build: ctypes.CDLL) -> None:
    native = NativeRecords(build)
    tick = np.random.default_rng(1).integers(0, 256, 1000, dtype=np.uint8)
    plain = np.tile(tick, 400)
    frame = packed(native, plain, similar_of(400, 1000, [(0, 1000, 0, 0)]))
    assert len(plain) > 3 * _BLOCK
    assert len(frame) < 1000 + 400 * 8


def test_a_damaged_frame_is_noticed(build: ctypes.CDLL) -> None:
    native = NativeRecords(build)
    plain = np.tile(np.arange(200, dtype=np.uint8), 50)
    frame = bytearray(packed(native, plain, similar_of(50, 200, [(0, 200, 0, 0)])))
    frame[40] ^= 1  # one of the first bytes, which the others repeat
    with pytest.raises(zstandard.ZstdError, match="checksum"):
        zstandard.ZstdDecompressor().decompress(bytes(frame))


def test_the_index_of_some_channels(build: ctypes.CDLL) -> None:
    native = NativeRecords(build)
    begins, heads, channels = integers([0, 500, 1300]), integers([0, 70]), integers([3, 777])
    moments = integers([[1, 10**12, 5], [2, 10**12 + 7, 6], [3, 10**12 + 9, 7]])
    index = np.zeros(2 * (15 + 16 * 3), dtype=np.uint8)
    batch = native.batch()
    batch.index(begins, moments, heads, channels, index)
    batch.run()
    wanted = [
        message_index(number, np.stack((moments[:, 1], begins + head), axis=1))
        for number, head in zip(channels.tolist(), heads.tolist(), strict=True)
    ]
    assert index.tobytes() == b"".join(wanted)
