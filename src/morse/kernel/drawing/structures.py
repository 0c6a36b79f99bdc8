"""The structure ``Frame`` of ``c/drawing.h``."""

from __future__ import annotations

import ctypes
from typing import TYPE_CHECKING

from morse.kernel.memory import address

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

_ADDRESSES = """vertices triangles clusters spheres parts slots materials texels textures lamps sky samples encoded
    closed guards levels
    models turns cameras shadow sun near_shadow near_sun lamp_shadow lamp_frame
    shadow_bounds near_bounds lamp_bounds shadow_changes near_changes points corners point_counts boxes
    jobs found starts counts chunks shares seen bounds firsts members tiles drawn kept rgba depth ids normals"""
_NUMBERS = """part_count lamp_count sample_count camera_count job_count tile_count shadow_width shadow_height
    near_width near_height lamp_width lamp_height cluster_count chunk_count thread_count"""
_SIZES = "seen_count member_count member_room drawn_count change"
#: four stages of an image, each with four ranges of work of three numbers, and the number of complete pieces
_Stages = ctypes.c_int64 * (4 * (4 * 3 + 1))


class FrameStructure(ctypes.Structure):
    """``Frame``. It holds references to the arrays that it points to."""

    _fields_ = (
        *[(name, ctypes.c_void_p) for name in _ADDRESSES.split()],
        *[(name, ctypes.c_int32) for name in _NUMBERS.split()],
        *[(name, ctypes.c_int64) for name in _SIZES.split()],
        ("stages", _Stages),
        ("arrived", ctypes.c_int64),
    )

    def __init__(self) -> None:
        super().__init__()
        self._kept: dict[str, NDArray[np.generic] | None] = {}

    def point(self, **arrays: NDArray[np.generic] | None) -> None:
        """Set addresses to those of contiguous arrays, or to null."""
        memory = self._kept
        for name, array in arrays.items():
            # the memory of an array does not move
            if name not in memory or memory[name] is not array:
                setattr(self, name, address(array))
                memory[name] = array

    def restart(self) -> None:
        """Begin with the first piece of the first stage."""
        self.stages, self.arrived = _Stages(), 0

    def forget(self, *names: str) -> None:
        """Release arrays that the frame points to."""
        self.point(**dict.fromkeys(names))
