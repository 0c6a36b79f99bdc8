"""The forces of water on a vessel."""

from __future__ import annotations

from ctypes import byref
from typing import TYPE_CHECKING

from morse.kernel.loading import library
from morse.kernel.water.values import WaterValues

if TYPE_CHECKING:
    from collections.abc import Callable

__all__ = ["WaterValues", "pusher"]


def pusher(values: WaterValues) -> Callable[[], object]:
    """The function that computes force and torque in values."""
    push, place = library().morse_water, byref(values)
    push.restype = None
    return lambda: push(place)
