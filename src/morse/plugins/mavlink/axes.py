"""Conversion between the axes of MORSE (X forward, Y left, Z up) and of MAVLink (X north or forward, Z down)."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from morse.helpers.geodesy import LocalPlane, has_place
from morse.mathutils.portable import matmul
from morse.mathutils.rotations import (
    both_eulers,
    product,
    quaternion_from_rotation,
    rotation_from_quaternion,
    turn,
)

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from morse.mathutils.rotations import Quaternion4, Rotation9, Triple


#: a covariance of MAVLink without values
UNKNOWN_COVARIANCE = [math.nan] + [0.0] * 20
_SAME: Rotation9 = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)
#: each of these matrices is its own inverse
_NWU: Rotation9 = (1.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, -1.0)
_ENU: Rotation9 = (0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, -1.0)


class Axes:
    """Converts vectors and rotations from a frame of the world to north, east, down, and back.

    Args:
        frame: ``nwu``, ``enu`` or ``ned``. Bodies in the frame ``ned`` have X forward, Y right and Z down.
    """

    def __init__(self, frame: str) -> None:
        self.frame = frame
        self._world = {"nwu": _NWU, "enu": _ENU, "ned": _SAME}[frame]
        self._body = _SAME if frame == "ned" else _NWU

    def vector(self, v: Sequence[float]) -> Triple:
        """Convert a vector (3,) of the world; the inverse is the same."""
        return turn(self._world, [float(number) for number in v])

    def body(self, v: Sequence[float]) -> Triple:
        """Convert a vector (3,) in the axes of the vehicle; the inverse is the same."""
        return turn(self._body, [float(number) for number in v])

    def rotation(self, wxyz: Sequence[float]) -> Rotation9:
        """Convert a rotation matrix of the vehicle; the inverse is the same."""
        w, x, y, z = (float(number) for number in wxyz)
        return product(self._world, product(rotation_from_quaternion(w, x, y, z), self._body))

    def quaternion(self, wxyz: Sequence[float]) -> Quaternion4:
        """Convert a quaternion of the vehicle; the inverse is the same."""
        return quaternion_from_rotation(self.rotation(wxyz))

    def angles(self, wxyz: Sequence[float]) -> Triple:
        """Roll, pitch and yaw of the vehicle, rad."""
        return both_eulers(self.rotation(wxyz), "XYZ")[0]

    def angles_of(self, rotation: Rotation9) -> Triple:
        """Roll, pitch and yaw of a rotation matrix of MORSE, rad."""
        return both_eulers(product(self._world, product(rotation, self._body)), "XYZ")[0]

    def covariance(self, matrix: object, *, of_body: bool = False) -> list[float]:
        """The upper triangle (21) of a covariance (6, 6) of two vectors; NaN first, which means unknown, for None.

        Args:
            matrix: order x, y, z, and rotations about X, Y, Z, fixed axes.
            of_body: whether the vectors are in the axes of the vehicle.
        """
        if matrix is None:
            return UNKNOWN_COVARIANCE
        axes = np.reshape(self._body if of_body else self._world, (3, 3))
        both = np.zeros((6, 6))
        both[:3, :3] = both[3:, 3:] = axes
        rotated_matrix = matmul(matmul(both, np.asarray(matrix, dtype=np.float64)), both.T)
        return [float(number) for number in rotated_matrix[np.triu_indices(6)]]

    def heading(self, yaw: float) -> float:
        """The yaw of a heading from north, clockwise, rad."""
        return {"nwu": -yaw, "enu": math.pi / 2.0 - yaw, "ned": yaw}[self.frame]


#: degrees and m; the place of worlds that declare none: the start of PX4's own simulations
_ZURICH = {"longitude": 8.545594, "latitude": 47.397742, "altitude": 488.0}


class Place:
    """North, east and down from where the vehicle was when the simulation started; and places on the earth.

    Args:
        axes: of the world.
        origin: position of the robot at the start, m in the world.
        properties: of the environment.
        x_axis: angle of the X axis of the world from east, rad.
    """

    def __init__(self, axes: Axes, origin: Triple, properties: Mapping[str, object], x_axis: float) -> None:
        self.axes, self.origin = axes, origin
        source = properties if has_place(properties) else _ZURICH
        self._plane = LocalPlane.of({**source, "angle_against_north": x_axis})

    def local(self, position: Triple) -> Triple:
        """North, east, down of a position in the world, m."""
        return self.axes.vector([a - b for a, b in zip(position, self.origin, strict=True)])

    def world(self, local: Triple) -> Triple:
        """The inverse of `local`."""
        x, y, z = self.axes.vector(local)
        return x + self.origin[0], y + self.origin[1], z + self.origin[2]

    def earth(self, position: Triple) -> Triple:
        """Latitude and longitude, degrees, and altitude, m, of a position in the world."""
        longitude, latitude, altitude = self._plane.geodetic_of(position)
        return latitude, longitude, altitude

    def from_earth(self, latitude: float, longitude: float, altitude: float) -> Triple:
        """The inverse of `earth`."""
        return self._plane.world_of_geodetic(longitude, latitude, altitude)

    def heading(self, yaw: float) -> float:
        """Convert the yaw of a body in the world to clockwise from north, and back, rad."""
        return math.remainder(self.axes.heading(yaw), math.tau)
