"""The values of a vessel in the water, shared by C and Python."""

from __future__ import annotations

from ctypes import Structure, byref, c_double
from typing import TYPE_CHECKING

from morse.kernel.loading import library

if TYPE_CHECKING:
    from collections.abc import Callable


__all__ = ["WaterValues", "pusher"]


_Three = c_double * 3


class WaterValues(Structure):
    """``Water`` of ``c/water.c``: a box of eight cells in the water; all vectors are in the frame of the body.

    Attributes:
        cells: (8, 3) middles of the cells, m.
        swell, rise: height of the surface above the calm one, m, and its speed, m/s, for each column of two cells.
        centre: of the box, m.
        drag: force over the square of the speed along each axis, kg/m.
        depth: height of the surface above the origin of the body, m.
        half: half the height of the box, m.
        lift: buoyancy of a submerged cell, N.
        most: limit of force over speed, kg/s.
        bob: linear damping of the vertical speed of a cell at the surface, kg/s.
        up: the upward direction.
        linear, angular: velocity in the water, m/s and rad/s.
        force, torque: results, N and N m.
    """

    _fields_ = (
        ("cells", _Three * 8),
        ("swell", c_double * 4),
        ("rise", c_double * 4),
        ("centre", _Three),
        ("drag", _Three),
        ("depth", c_double),
        ("half", c_double),
        ("lift", c_double),
        ("most", c_double),
        ("bob", c_double),
        ("up", _Three),
        ("linear", _Three),
        ("angular", _Three),
        ("force", _Three),
        ("torque", _Three),
    )


def pusher(values: WaterValues) -> Callable[[], object]:
    """The function that computes force and torque in values."""
    push, place = library().morse_water, byref(values)
    push.restype = None
    return lambda: push(place)
