"""The shadows of objects that move, drawn by the C functions."""

from __future__ import annotations

import ctypes
from typing import TYPE_CHECKING

import numpy as np

from morse.kernel.memory import address

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from morse.kernel.drawing.arrays import Light, Poses
    from morse.kernel.drawing.structures import FrameStructure


class _Movers(ctypes.Structure):
    """``Movers`` of ``c/draw_shadow.c``."""

    _fields_ = (
        *[
            (name, ctypes.c_void_p)
            for name in (
                *(
                    "parts",
                    "left_out",
                    "base",
                    "models",
                    "touched",
                    "extents",
                    "again",
                    "changed",
                    "stale",
                    "bounds",
                    "changes",
                ),
            )
        ],
        ("count", ctypes.c_int32),
        ("spare", ctypes.c_int32),
    )


class NativeMovers:
    """The shadows of parts that may move.

    Args:
        parts: (M,) the parts.
        light: with the map, which has the shadows of all other parts already.

    Attributes:
        touched: (M, 4) int32, the texels that each part may fill: x0, y0, x1, y1, one past the end; zeros if the map
            does not show it.
        extents: (M, 4) the same; not zeros for parts whose shadows no camera sees.
    """

    def __init__(self, library: ctypes.CDLL, frame: FrameStructure, parts: NDArray[np.integer], light: Light) -> None:
        shadow, bounds = light.shadow, light.shadow_bounds
        assert shadow is not None
        self._function, self._frame, self._light = library.morse_draw_movers, frame, light
        count = len(parts)
        self.touched = np.zeros((count, 4), np.int32)
        # one more than needed: an empty array has no address
        self.extents = np.zeros((count, 4), np.int32)
        self._left_out = np.zeros(count + 1, np.uint8)
        self._arrays: dict[str, NDArray[np.generic] | None] = {
            "parts": np.append(parts, 0).astype(np.int32),
            "left_out": self._left_out,
            "base": shadow.copy(),
            "models": np.zeros((count + 1, 12), np.float32),
            "touched": self.touched,
            "extents": self.extents,
            "again": np.zeros(count + 1, np.uint8),
            "changed": np.zeros((2 * count + 1, 4), np.int32),
            "stale": None if bounds is None else np.zeros(bounds.shape[:2], np.uint8),
            "bounds": bounds,
            "changes": light.shadow_changes,
        }
        self._movers = _Movers(**{name: address(array) for name, array in self._arrays.items()}, count=count)

    def update(self, poses: Poses, cameras: NDArray[np.void], left_out: NDArray[np.bool_] | None = None) -> None:
        """Draw the shadows of parts that have moved again, if a camera may see them.

        Args:
            cameras: (K,) `CAMERA`.
            left_out: (M,) the parts whose shadows are not needed.
        """
        frame, light = self._frame, self._light
        assert light.shadow is not None
        self._left_out[:-1] = False if left_out is None else left_out
        frame.point(shadow=light.shadow, sun=light.sun, models=poses.models, cameras=cameras)
        frame.camera_count = len(cameras)
        frame.shadow_height, frame.shadow_width = light.shadow.shape
        self._function(ctypes.byref(frame), ctypes.byref(self._movers))
        frame.forget("cameras")
