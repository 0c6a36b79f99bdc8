"""Between the axes of MORSE (X forward, Y left, Z up) and those of MAVLink (X north or forward, Z down)."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from morse.mathutils.rotations import (
    both_eulers,
    product,
    quaternion_from_rotation,
    rotation_from_quaternion,
    turn,
)

if TYPE_CHECKING:
    from collections.abc import Sequence

    from morse.mathutils.rotations import Quaternion4, Rotation9, Triple

_SAME: Rotation9 = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)
#: each of them is its own inverse
_NWU: Rotation9 = (1.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, -1.0)
_ENU: Rotation9 = (0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, -1.0)


class Axes:
    """How vectors and rotations in a frame of the world become those of north, east and down, and back.

    Args:
        frame: ``nwu``, ``enu`` or ``ned``. Things in the frame ``ned`` have X forward, Y right and Z down themselves.
    """

    def __init__(self, frame: str) -> None:
        self.frame = frame
        self._world = {"nwu": _NWU, "enu": _ENU, "ned": _SAME}[frame]
        self._body = _SAME if frame == "ned" else _NWU

    def vector(self, v: Sequence[float]) -> Triple:
        """(3,) of the world; the way back is the same."""
        return turn(self._world, [float(number) for number in v])

    def body(self, v: Sequence[float]) -> Triple:
        """(3,) along the axes of the vehicle; the way back is the same."""
        return turn(self._body, [float(number) for number in v])

    def rotation(self, wxyz: Sequence[float]) -> Rotation9:
        """Of the vehicle, as a matrix; the way back is the same."""
        w, x, y, z = (float(number) for number in wxyz)
        return product(self._world, product(rotation_from_quaternion(w, x, y, z), self._body))

    def quaternion(self, wxyz: Sequence[float]) -> Quaternion4:
        """Of the vehicle; the way back is the same."""
        return quaternion_from_rotation(self.rotation(wxyz))

    def angles(self, wxyz: Sequence[float]) -> tuple[float, float, float]:
        """Roll, pitch and yaw of the vehicle, rad."""
        return both_eulers(self.rotation(wxyz), "XYZ")[0]

    def heading(self, yaw: float) -> float:
        """The yaw of a heading from north, clockwise, rad."""
        return {"nwu": -yaw, "enu": math.pi / 2.0 - yaw, "ned": yaw}[self.frame]
