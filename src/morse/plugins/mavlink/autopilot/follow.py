"""Follows a target that tells where it is, by FOLLOW_TARGET."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from morse.mathutils.rotations import Triple
    from morse.plugins.mavlink.autopilot.craft import Craft
    from morse.plugins.mavlink.messages import MavlinkMessage

#: s after which a target no longer counts; m/s below which it has no direction; MAV_FOLLOW: bit of its velocity
_SILENT, _SLOW, _HAS_VELOCITY = 3.0, 0.5, 1 << 1


class Follow:
    """Where to go: at a distance from the target, an angle from its course and a height above home, as with PX4."""

    def __init__(self, flight: Craft) -> None:
        self._flight = flight
        self.reset()

    def reset(self) -> None:
        """The simulation has started again."""
        self._target: Triple | None = None
        #: to where it moves, from the X axis of the world, rad; s since the last message
        self._course: float | None = None
        self._age = math.inf

    def take(self, message: MavlinkMessage) -> None:
        """FOLLOW_TARGET."""
        if not (abs(message.lat) <= 900_000_000 and abs(message.lon) <= 1_800_000_000):
            return
        place = self._flight.place
        self._target = place.from_earth(message.lat * 1e-7, message.lon * 1e-7, place.earth(self._flight.home)[2])
        self._age = 0.0
        velocity = message.vel
        if message.est_capabilities & _HAS_VELOCITY and _SLOW < math.hypot(*velocity[:2]) < 1e4:
            x, y, _ = place.axes.vector((velocity[0], velocity[1], 0.0))
            self._course = math.atan2(y, x)

    def goal(self) -> tuple[Triple, float] | None:
        """Position, m, and yaw, rad, in the world; None without a target."""
        flight = self._flight
        self._age += flight.now.dt
        if self._target is None or self._age > _SILENT:
            return None
        values, here = flight.parameters, flight.now.position
        x, y, _ = self._target
        if self._course is None:
            angle = math.atan2(here[1] - y, here[0] - x)
        else:
            # from the course clockwise; the Z axis of the world points up
            angle = self._course - math.radians(values["FLW_TGT_FA"])
        distance = values["FLW_TGT_DST"]
        z = flight.home[2] + values["FLW_TGT_HT"] if flight.goes_up else here[2]
        goal = (x + distance * math.cos(angle), y + distance * math.sin(angle), z)
        return goal, math.atan2(y - here[1], x - here[0])
