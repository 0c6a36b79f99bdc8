"""The frame in which a vehicle is told where to go and reports where it is."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from morse.helpers.geodesy import LocalPlane, has_place

if TYPE_CHECKING:
    from collections.abc import Mapping

    from morse.mathutils.rotations import Triple
    from morse.plugins.mavlink.axes import Axes

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
