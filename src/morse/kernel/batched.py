"""The ticks and the scans of many simulations, by one call of a C function."""

from __future__ import annotations

import ctypes
from ctypes import c_int64, c_void_p
from typing import TYPE_CHECKING

import numpy as np

from morse.kernel.loading import library
from morse.kernel.memory import address

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from morse.kernel.driving import Course


class Lane(ctypes.Structure):
    """``Lane`` of ``c/batched.c``: what a scan of a row needs."""

    _fields_ = (*((name, c_void_p) for name in ("placing", "moving", "solids", "rays")), ("count", c_int64))
    #: the objects to whose memory it points
    keep: object = None


class _BatchedStructure(ctypes.Structure):
    """``Batched`` of ``c/batched.c``."""

    _fields_ = (*((name, c_void_p) for name in ("courses", "positions", "rotations")), ("groups", c_int64))


class Courses:
    """The robots of N simulations.

    Args:
        rows: N.
        groups: number of rigid groups of each simulation, K.

    Attributes:
        positions, rotations: (N, K, 3) m, (N, K, 9): the poses of the groups, which `run` updates.
    """

    def __init__(self, rows: int, groups: int) -> None:
        self.positions, self.rotations = np.zeros((rows, groups, 3)), np.zeros((rows, groups, 9))
        self._places = (c_void_p * rows)()
        self._keep: list[Course | None] = [None] * rows
        arrays = address(self.positions), address(self.rotations)
        self._all = ctypes.byref(_BatchedStructure(ctypes.addressof(self._places), *arrays, groups))
        kernel = library()
        self._run = kernel.morse_batched_run
        self._run.argtypes, self._run.restype = (c_void_p, c_void_p, c_int64, c_int64, c_void_p), None

    def set(self, row: int, course: Course) -> None:
        """Set the robots of a row, whose commands are known to the course."""
        self._keep[row], self._places[row] = course, course.place

    def run(self, rows: NDArray[np.int64], ticks: int) -> NDArray[np.int64]:
        """Run ticks in some rows; return their numbers (M,), which are smaller if a robot does not glide."""
        done = np.zeros(len(rows), np.int64)
        self._run(self._all, address(rows), len(rows), ticks, address(done))
        return done


class Lanes:
    """A scan of N simulations.

    Args:
        rows: N.
    """

    def __init__(self, rows: int) -> None:
        self._lanes = (Lane * rows)()
        self._keep: list[object] = [None] * rows
        kernel = library()
        self._cast = kernel.morse_batched_cast
        self._cast.argtypes, self._cast.restype = (c_void_p, c_void_p, c_int64), None

    def set(self, row: int, lane: Lane) -> None:
        """Set what the scan of a row needs."""
        self._lanes[row], self._keep[row] = lane, lane.keep

    def cast(self, rows: NDArray[np.int64]) -> None:
        """Cast the rays of some rows."""
        self._cast(self._lanes, address(rows), len(rows))
