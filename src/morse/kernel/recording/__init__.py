"""Records of many ticks, encoded in one call without the GIL.

The reference is the encoding of the streams of ROS 2, which encode one message at a time. `morse.recording.captures`
compares the messages of one tick with it.
"""

from __future__ import annotations

from morse.kernel.loading import library
from morse.kernel.recording.arrays import Numbers, Poses, Rows, Scans, Similar
from morse.kernel.recording.batch import Batch
from morse.kernel.recording.native import NativeRecords

__all__ = ["Batch", "NativeRecords", "Numbers", "Poses", "Rows", "Scans", "Similar", "records"]


def records() -> NativeRecords | None:
    """The encoder of records; None without the kernel."""
    loaded = library()
    return None if loaded is None else NativeRecords(loaded)
