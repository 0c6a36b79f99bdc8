"""Steps of the encoding of a chunk, which C runs in one call.

Each call of a C function gives up the GIL, and has to wait for it afterwards: the simulation loses it for longer than
most steps take.
"""

from __future__ import annotations

import ctypes
from ctypes import addressof, c_int64, c_void_p
from typing import TYPE_CHECKING, Any

import numpy as np

from morse.kernel.memory import address

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from morse.kernel.recording.arrays import Bytes, Floats, Integers, Numbers, Poses, Rows, Scans, Similar
    from morse.kernel.recording.functions import Functions

#: kinds of steps: those of ``c/record_batch.c``
_ROWS, _POSES, _FRAMES, _SCANS, _INDEX, _PACK, _APPEND, _NUMBERS = range(8)
#: columns of a step: kind, result, arguments
_RESULT, _COLUMNS = 1, 10
#: size of a block of a frame, bytes
_BLOCK = 1 << 17


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


class _NumbersStructure(ctypes.Structure):
    """``RecordNumbers`` of ``c/record.h``."""

    _fields_ = (("columns", c_int64), ("data", c_void_p), ("numbers", c_int64), ("which", c_void_p))


class _TicksStructure(ctypes.Structure):
    """``PackTicks`` of ``c/record.h``."""

    _fields_ = (
        ("ticks", c_int64),
        ("begins", c_void_p),
        ("layouts", c_void_p),
        ("firsts", c_void_p),
        ("spans", c_void_p),
        ("columns", c_int64),
        ("last", c_void_p),
    )


class Room:
    """Memory of `Batch.pack`, which is reused: the first access to new memory takes a while."""

    def __init__(self) -> None:
        self._made: NDArray[np.uint32] | None = None

    def numbers(self) -> NDArray[np.uint32]:
        """Three numbers for each eight bytes of a block."""
        if self._made is None:
            self._made = np.empty(3 * _BLOCK // 8, dtype=np.uint32)
        return self._made


class Batch:
    """Steps that run in their order in `run`; the arrays are described in `morse.kernel.recording.arrays`.

    Args:
        run: the C function.
        functions: of Python for angles; None if they are not available.
        room: memory for the compression.
    """

    def __init__(self, run: Any, functions: Functions | None, room: Room) -> None:
        self._run, self._functions, self._room = run, functions, room
        self._steps: list[tuple[int, ...]] = []
        self._mends: list[tuple[Callable[[Bytes], object], Bytes] | None] = []
        self._kept: list[Any] = []

    def rows(self, rows: Rows) -> None:
        """Copy the templates, and write the times."""
        self._add(_ROWS, self._rows(rows))

    def poses(self, rows: Rows, poses: Poses, mend: Callable[[Bytes], object]) -> None:
        """Write poses as measured by the sensor `Pose`.

        Args:
            rows: see `Rows`.
            poses: see `Poses`.
            mend: called if poses are left to Python, with (R, N) 1 for each of them and 0 for the others.
        """
        assert self._functions is not None
        left = _left(rows, poses)
        arguments = self._rows(rows), self._poses(poses), addressof(self._functions), address(left)
        self._add(_POSES, *arguments, mend=(mend, left))

    def frames(
        self, rows: Rows, poses: Poses, origins: Floats, parents: Integers, mend: Callable[[Bytes], object]
    ) -> None:
        """Write poses in other frames.

        Args:
            rows: see `Rows`.
            poses: see `Poses`.
            origins: (N, 12) position, m, and rotation of these frames in the world.
            parents: (N,) rigid group with the frame, which moves; -1 for the frame in `origins`.
            mend: see `poses`.
        """
        left = _left(rows, poses)
        self._kept += (origins, parents)
        arrays = address(origins), address(parents), address(left)
        arguments = self._rows(rows), self._poses(poses), *arrays
        self._add(_FRAMES, *arguments, mend=(mend, left))

    def scans(self, rows: Rows, scans: Scans) -> None:
        """Write distances in single precision; infinite at or above the range."""
        self._kept.append(scans)
        arrays = address(scans.distances), address(scans.reaches), address(scans.places)
        sizes = scans.rays, min(scans.kept, scans.rays)
        self._add(_SCANS, self._rows(rows), len(scans.members), address(scans.members), *sizes, *arrays)

    def numbers(self, rows: Rows, numbers: Numbers) -> None:
        """Write numbers of the data of sensors."""
        data, which = numbers
        made = _NumbersStructure(data.shape[1], address(data), len(which), address(which))
        self._kept += (numbers, made)
        self._add(_NUMBERS, self._rows(rows), addressof(made))

    def index(self, begins: Integers, moments: Integers, heads: Integers, channels: Integers, index: Bytes) -> None:
        """Write the records ``MessageIndex`` of some channels.

        Args:
            begins: (R,) offset of the first record of each tick in the chunk.
            moments: (R, 3) number of the tick, log time (ns), simulated time (ns).
            heads: (H,) offset of the record of each channel in those of a tick.
            channels: (H,) their ids.
            index: (H * (15 + 16 R),) receives the records.
        """
        self._kept += (begins, moments, heads, channels, index)
        arrays = address(heads), address(channels), address(index)
        self._add(_INDEX, len(begins), address(begins), address(moments), len(heads), *arrays)

    def pack(self, plain: Bytes, similar: Similar, frame: Bytes, after: Bytes | None = None) -> Callable[[], int]:
        """Compress records of ticks into a frame of Zstandard.

        Args:
            plain: (size,) the records.
            similar: where they resemble each other.
            frame: (5 / 4 size + 1024 + bytes of `after`,) receives the frame, and then `after`.
            after: bytes that follow the frame.

        Returns:
            A function that returns the size of the frame, bytes, after `run`.
        """
        last, room = np.empty(similar.columns, dtype=np.int64), self._room.numbers()
        arrays = similar.begins, similar.layouts, similar.firsts, similar.spans
        ticks = _TicksStructure(len(similar.begins), *map(address, arrays), similar.columns, address(last))
        self._kept += (plain, similar, frame, last, room, ticks, after)
        step = len(self._steps)
        self._add(_PACK, address(plain), len(plain), addressof(ticks), address(frame), address(room))
        if after is not None and len(after):
            self._add(_APPEND, address(frame), address(after), len(after))
        return lambda: int(self._table[step, _RESULT])

    def run(self) -> None:
        """Run all steps. Messages that are left to Python are written between them."""
        table = self._table = np.zeros((len(self._steps), _COLUMNS), dtype=np.int64)
        for k, (kind, *arguments) in enumerate(self._steps):
            table[k, 0] = kind
            table[k, 2 : 2 + len(arguments)] = arguments
        done, size = 0, _COLUMNS * table.itemsize
        begin: int = table.ctypes.data
        while done < len(table):
            done += self._run(c_void_p(begin + done * size), c_int64(len(table) - done))
            mend = self._mends[done - 1]
            if mend is not None and table[done - 1, _RESULT]:
                mend[0](mend[1])

    def _add(self, *step: int | None, mend: tuple[Callable[[Bytes], object], Bytes] | None = None) -> None:
        self._steps.append(tuple(argument or 0 for argument in step))
        self._mends.append(mend)

    def _rows(self, rows: Rows) -> int:
        made = _RowsStructure(
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
        self._kept += (rows, made)
        return addressof(made)

    def _poses(self, poses: Poses) -> int:
        made = _PosesStructure(
            address(poses.positions),
            address(poses.rotations),
            len(poses.slots),
            address(poses.slots),
            address(poses.offsets),
            address(poses.turned),
            address(poses.apart),
            address(poses.places),
        )
        self._kept += (poses, made)
        return addressof(made)


def _left(rows: Rows, poses: Poses) -> Bytes:
    return np.zeros((len(rows.begins), len(poses.slots)), dtype=np.uint8)
