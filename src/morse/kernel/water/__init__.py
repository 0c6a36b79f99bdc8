"""The forces of water on a vessel."""

from __future__ import annotations

from ctypes import byref
from typing import TYPE_CHECKING

from morse.kernel.loading import library
from morse.kernel.water import reference
from morse.kernel.water.values import WaterValues

if TYPE_CHECKING:
    from collections.abc import Callable

__all__ = ["WaterValues", "pusher"]


def pusher(values: WaterValues) -> Callable[[], object]:
    """The function that computes force and torque in values: C, or Python without the kernel."""
    kernel_library = library()
    if kernel_library is None:
        return lambda: reference.push(values)
    kernel_library.morse_water.restype = None
    push, place = kernel_library.morse_water, byref(values)
    return lambda: push(place)
