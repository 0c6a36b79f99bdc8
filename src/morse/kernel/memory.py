"""Arrays in the form that C functions want."""

from __future__ import annotations

import ctypes
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import DTypeLike, NDArray

#: bytes: where vectors of eight numbers may start, and cache lines do
_ALIGNMENT = 64


def aligned(count: int, dtype: DTypeLike) -> NDArray[Any]:
    """A new array (count,) that starts where vectors may."""
    size = count * np.dtype(dtype).itemsize
    whole = np.empty(size + _ALIGNMENT, dtype=np.uint8)
    start = -whole.ctypes.data % _ALIGNMENT
    return whole[start : start + size].view(dtype)


def address(array: NDArray[Any] | None) -> int | None:
    """Where the numbers of an array are; None for none.

    Whoever hands the address over has to keep the array.

    Raises:
        ValueError: the array is not in one piece.
    """
    if array is None:
        return None
    if not array.flags.c_contiguous:
        raise ValueError(f"an array of the shape {array.shape} is not in one piece")
    place: int = array.__array_interface__["data"][0]  # a third of the time of ``ctypes.data``
    return place


def addresses(*arrays: NDArray[Any] | None) -> list[int | None]:
    """The same of some arrays."""
    return [address(array) for array in arrays]


def pointer(array: NDArray[Any] | None) -> ctypes.c_void_p:
    """The same as an argument of a function."""
    return ctypes.c_void_p(address(array))
