"""Records of many ticks, by C functions."""

from __future__ import annotations

import ctypes
from ctypes import byref, c_int64, c_void_p
from typing import TYPE_CHECKING

import numpy as np

from morse.kernel.memory import address, pointer
from morse.kernel.recording.functions import functions

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from morse.kernel.recording.arrays import Bytes, Floats, Integers, Poses, Rows, Scans, Similar


class _RowsStructure(ctypes.Structure):
    """``RecordRows`` of ``c/record.h``."""

    _fields_ = (
        ("rows", c_int64),
        ("size", c_int64),
        ("begins", c_void_p),
        ("moments", c_void_p),
        ("templates", c_void_p),
        ("heads", c_int64),
        ("head_places", c_void_p),
        ("stamps", c_int64),
        ("stamp_places", c_void_p),
        ("chunk", c_void_p),
    )


class _PosesStructure(ctypes.Structure):
    """``RecordPoses`` of ``c/record.h``."""

    _fields_ = (
        ("positions", c_void_p),
        ("rotations", c_void_p),
        ("members", c_int64),
        ("slot", c_void_p),
        ("offsets", c_void_p),
        ("turned", c_void_p),
        ("apart", c_void_p),
        ("places", c_void_p),
    )


class _TicksStructure(ctypes.Structure):
    """``PackTicks`` of ``c/record_pack.c``."""

    _fields_ = (
        ("ticks", c_int64),
        ("begins", c_void_p),
        ("layouts", c_void_p),
        ("firsts", c_void_p),
        ("spans", c_void_p),
        ("columns", c_int64),
        ("last", c_void_p),
    )


#: number of 32-bit integers that `NativeRecords.pack` needs: three for each eight bytes of a block
_ROOM = 3 * (1 << 17) // 8


class NativeRecords:
    """Writes records into a chunk; the arrays are described in `morse.kernel.recording.arrays`."""

    def __init__(self, library: ctypes.CDLL) -> None:
        self._rows, self._scans = library.morse_record_rows, library.morse_record_scans
        self._poses, self._frames = library.morse_record_poses, library.morse_record_frames
        self._index, self._pack = library.morse_record_index, library.morse_record_pack
        self._rows.restype = self._scans.restype = self._index.restype = None
        self._poses.restype = self._frames.restype = self._pack.restype = c_int64
        self._functions = functions()

    @property
    def measures_poses(self) -> bool:
        """Whether the functions of Python for angles are available."""
        return self._functions is not None

    def rows(self, rows: Rows) -> None:
        """Copy the templates, and write the times."""
        self._rows(byref(_rows(rows)))

    def poses(self, rows: Rows, poses: Poses) -> Bytes:
        """Write poses as measured by the sensor `Pose`.

        Returns:
            (R, N) 1 for a pose that is left to Python, 0 for the others.
        """
        assert self._functions is not None
        left = _left(rows, poses)
        self._poses(byref(_rows(rows)), byref(_poses(poses)), byref(self._functions), pointer(left))
        return left

    def frames(self, rows: Rows, poses: Poses, origins: Floats) -> Bytes:
        """Write poses in other frames.

        Args:
            rows: see `Rows`.
            poses: see `Poses`.
            origins: (N, 12) position, m, and rotation of these frames in the world.

        Returns:
            (R, N) 1 for a pose that is left to Python, 0 for the others.
        """
        left = _left(rows, poses)
        self._frames(byref(_rows(rows)), byref(_poses(poses)), pointer(origins), pointer(left))
        return left

    def scans(self, rows: Rows, scans: Scans) -> None:
        """Write distances in single precision; infinite at or above the range."""
        sizes = c_int64(scans.rays), c_int64(min(scans.kept, scans.rays))
        members = c_int64(len(scans.members)), pointer(scans.members)
        arrays = pointer(scans.distances), pointer(scans.reaches), pointer(scans.places)
        self._scans(byref(_rows(rows)), *members, *sizes, *arrays)

    def index(
        self, begins: Integers, moments: Integers, heads: Integers, channels: Integers, index: NDArray[np.uint8]
    ) -> None:
        """Write the records ``MessageIndex`` of some channels.

        Args:
            begins: (R,) offset of the first record of each tick in the chunk.
            moments: (R, 3) number of the tick, log time (ns), simulated time (ns).
            heads: (H,) offset of the record of each channel in those of a tick.
            channels: (H,) their ids.
            index: (H * (15 + 16 R),) receives the records.
        """
        arrays = pointer(begins), pointer(moments), c_int64(len(heads)), pointer(heads), pointer(channels)
        self._index(c_int64(len(begins)), *arrays, pointer(index))

    def pack(self, plain: Bytes, similar: Similar, frame: Bytes) -> int:
        """Compress records of ticks into a frame of Zstandard.

        Args:
            plain: (size,) the records.
            similar: where they resemble each other.
            frame: (5 / 4 size + 1024,) receives the frame.

        Returns:
            The size of the frame, bytes.
        """
        last, room = np.empty(similar.columns, dtype=np.int64), np.empty(_ROOM, dtype=np.uint32)
        arrays = similar.begins, similar.layouts, similar.firsts, similar.spans
        ticks = _TicksStructure(len(similar.begins), *map(address, arrays), similar.columns, address(last))
        size: int = self._pack(pointer(plain), c_int64(len(plain)), byref(ticks), pointer(frame), pointer(room))
        return size


def _left(rows: Rows, poses: Poses) -> Bytes:
    return np.zeros((len(rows.begins), len(poses.slots)), dtype=np.uint8)


def _rows(rows: Rows) -> _RowsStructure:
    return _RowsStructure(
        len(rows.begins),
        len(rows.templates),
        address(rows.begins),
        address(rows.moments),
        address(rows.templates),
        len(rows.heads),
        address(rows.heads),
        len(rows.stamps),
        address(rows.stamps),
        address(rows.chunk),
    )


def _poses(poses: Poses) -> _PosesStructure:
    return _PosesStructure(
        address(poses.positions),
        address(poses.rotations),
        len(poses.slots),
        address(poses.slots),
        address(poses.offsets),
        address(poses.turned),
        address(poses.apart),
        address(poses.places),
    )
