"""Records of many ticks, by C functions."""

from __future__ import annotations

import ctypes
from ctypes import byref, c_int64, c_void_p
from typing import TYPE_CHECKING

import numpy as np

from morse.kernel.memory import address, pointer
from morse.kernel.recording.functions import functions

if TYPE_CHECKING:
    from morse.kernel.recording.arrays import Bytes, Floats, Integers, Poses, Rows


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
        ("slots", c_int64),
        ("members", c_int64),
        ("slot", c_void_p),
        ("offsets", c_void_p),
        ("turned", c_void_p),
        ("apart", c_void_p),
        ("places", c_void_p),
    )


class NativeRecords:
    """Writes records into a chunk; the arrays are described in `morse.kernel.recording.arrays`."""

    def __init__(self, library: ctypes.CDLL) -> None:
        self._rows, self._scans = library.morse_record_rows, library.morse_record_scans
        self._poses, self._frames = library.morse_record_poses, library.morse_record_frames
        self._rows.restype = self._scans.restype = None
        self._poses.restype = self._frames.restype = c_int64
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

    def scans(self, rows: Rows, distances: Floats, kept: int, reaches: Floats, places: Integers) -> None:
        """Write distances in single precision; infinite at or above the range.

        Args:
            rows: see `Rows`.
            distances: (R, N, rays) m.
            kept: number of rays of each scan that are written; the first rays.
            reaches: (N,) m.
            places: (N,) offset of the distances in the templates.
        """
        _, members, rays = distances.shape
        sizes = c_int64(members), c_int64(rays), c_int64(min(kept, rays))
        self._scans(byref(_rows(rows)), *sizes, pointer(distances), pointer(reaches), pointer(places))


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
        poses.positions.shape[1],
        len(poses.slots),
        address(poses.slots),
        address(poses.offsets),
        address(poses.turned),
        address(poses.apart),
        address(poses.places),
    )
