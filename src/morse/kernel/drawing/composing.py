"""Pictures to which reflections and translucent surfaces are added."""

from __future__ import annotations

import ctypes
from ctypes import c_float, c_int32, c_int64, c_void_p
from typing import TYPE_CHECKING

import numpy as np

from morse.kernel.loading import library
from morse.kernel.memory import address, pointer

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from morse.kernel.drawing.arrays import Pictures

#: first column and row, and those after the last ones
Box = tuple[int, int, int, int]


class _Overlay(ctypes.Structure):
    """``Overlay`` of ``c/draw_compose.c``."""

    _fields_ = (
        *[(name, c_int32) for name in ("width", "left", "top", "columns", "rows", "mirrored")],
        *[(name, c_void_p) for name in ("first", "total", "ids", "image", "image_ids", "chosen")],
        ("share", c_float),
    )


def depths_of(depths: NDArray[np.float32], background: float) -> NDArray[np.float32]:
    """Return the depths, m; pixels without a surface have that of the background."""
    to = np.empty_like(depths)
    library().morse_draw_depths(pointer(depths), c_int64(depths.size), c_float(background), pointer(to))
    return to


def objects_of(ids: NDArray[np.int32], objects: NDArray[np.int32]) -> NDArray[np.int32]:
    """Return the pairs of numbers (..., 2) of instances, whose pairs are `objects` (I, 2); -1 for no instance."""
    to = np.empty((*ids.shape, 2), np.int32)
    library().morse_draw_objects(pointer(ids), c_int64(ids.size), pointer(np.ascontiguousarray(objects)), pointer(to))
    return to


class Composition:
    """A picture of the size of a camera; numbers are codes, 0 to 255.

    Args:
        pictures: the picture, whose colours are changed.
        exact: whether codes keep their fractions until the end, as translucent surfaces need it.
    """

    def __init__(self, pictures: Pictures, width: int, height: int, *, exact: bool) -> None:
        self._library, self._width, self._height = library(), width, height
        self._first, self._ids = pictures.rgba, pictures.ids
        self._total = pictures.rgba[:, :3].astype(np.float32) if exact else None

    def extent(self, chosen: NDArray[np.bool_]) -> Box | None:
        """Return the pixels around those that show chosen instances (I,), None for none."""
        box = (c_int32 * 4)()
        count = self._library.morse_draw_extent(
            pointer(self._ids), c_int32(self._width), c_int32(self._height), pointer(chosen), box
        )
        return (box[0], box[1], box[2], box[3]) if count else None

    def reflect(self, pictures: Pictures, box: Box, chosen: NDArray[np.bool_], share: float) -> None:
        """Add a share of what the chosen instances mirror, from a picture whose columns are from right to left."""
        self._draw(self._library.morse_draw_reflect, pictures, box, chosen, share, mirrored=True)

    def cover(self, pictures: Pictures, box: Box, chosen: NDArray[np.bool_], share: float) -> None:
        """Draw the chosen instances over the picture, with that share, from a picture in which they are opaque."""
        self._draw(self._library.morse_draw_over, pictures, box, chosen, share, mirrored=False)

    def _draw(
        self, function: object, pictures: Pictures, box: Box, chosen: NDArray[np.bool_], share: float, *, mirrored: bool
    ) -> None:
        left, top, right, bottom = box
        overlay = _Overlay(
            *(self._width, left, top, right - left, bottom - top, mirrored),
            *map(address, (self._first, self._total, self._ids, pictures.rgba, pictures.ids, chosen)),
            share,
        )
        function(ctypes.byref(overlay))  # type: ignore[operator]

    def codes(self) -> NDArray[np.uint8]:
        """(H, W, 3) the picture."""
        codes = np.empty((self._height, self._width, 3), np.uint8)
        self._library.morse_draw_codes(
            pointer(self._first), pointer(self._total), c_int64(self._width * self._height), pointer(codes)
        )
        return codes
