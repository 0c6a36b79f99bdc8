"""Ticks in which robots only glide, by one call of a C function."""

from __future__ import annotations

import ctypes
from ctypes import c_int64, c_void_p
from typing import TYPE_CHECKING

from morse.kernel.driving.native import NativeGliders
from morse.kernel.loading import library
from morse.kernel.memory import address

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy as np
    from numpy.typing import NDArray

    from morse.kernel.driving.arrays import GliderWork

_POINTERS = "robots model data integrate kinematics qpos positions rotations positions_before rotations_before"


class _CourseStructure(ctypes.Structure):
    """``Course`` of ``c/glide_ticks.c``."""

    _fields_ = (*((name, c_void_p) for name in _POINTERS.split()), ("count", c_int64))


class Course:
    """The robots of a world, for `ticks`.

    Args:
        model, data: addresses of the model and the state of the engine.
        functions: addresses of ``mj_integratePos`` and ``mj_kinematics``; None if they are not known.
        qpos: the coordinates in the engine.
        positions, rotations: (K, 3), (K, 9) views of the poses in the engine.
        positions_before, rotations_before: results, (K, 3), (K, 9): the poses at the beginning of the last tick.
    """

    def __init__(
        self,
        model: int,
        data: int,
        functions: Sequence[int | None] | None,
        qpos: NDArray[np.float64],
        positions: NDArray[np.float64],
        rotations: NDArray[np.float64],
        positions_before: NDArray[np.float64],
        rotations_before: NDArray[np.float64],
    ) -> None:
        kernel = library()
        self._robots: GliderWork | None = None
        self._is_able = functions is not None
        if functions is None:
            return
        self._keep = arrays = (qpos, positions, rotations, positions_before, rotations_before)
        self._structure = _CourseStructure(None, model, data, *functions, *map(address, arrays), len(positions))
        self._all = ctypes.byref(self._structure)
        self._run = kernel.morse_glide_ticks
        self._run.argtypes, self._run.restype = (c_void_p, c_int64), c_int64

    @property
    def place(self) -> int:
        """The address of the structure."""
        return ctypes.addressof(self._structure)

    def follow(self, robots: GliderWork) -> bool:
        """Set the robots; return False if the kernel cannot drive them."""
        if robots is not self._robots:
            if not self._is_able or not isinstance(robots, NativeGliders):
                return False
            self._robots = robots
            self._structure.robots = robots.place
        return True

    def ticks(self, robots: GliderWork, ticks: int) -> int:
        """Run ticks; return their number, which is 0 if a robot does not glide, or without the kernel."""
        if not self.follow(robots):
            return 0
        count: int = self._run(self._all, ticks)
        return count
