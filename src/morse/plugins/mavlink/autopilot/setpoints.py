"""Setpoints of the mode OFFBOARD, read from messages."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from morse.mathutils.rotations import Triple
    from morse.plugins.mavlink.autopilot.helms import Motion
    from morse.plugins.mavlink.autopilot.modes import Craft
    from morse.plugins.mavlink.axes import Place
    from morse.plugins.mavlink.framing import MavlinkMessage


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


_LOCAL_NED, _LOCAL_OFFSET = 1, 7
#: MAV_FRAME_BODY_NED, _BODY_OFFSET_NED, _BODY_FRD: forward, right, down, level
_BODY = (8, 9, 12)
#: frames of SET_POSITION_TARGET_GLOBAL_INT: above the sea, above home
_SEA, _HOME = (0, 5), (3, 6)
_NO_YAW, _NO_YAW_RATE = 1 << 10, 1 << 11
_FARTHEST = 1e7

_Partial = tuple[float | None, float | None, float | None]


class Setpoint(NamedTuple):
    """Where to go, or how fast; each axis has a position, a velocity or neither.

    Attributes:
        position: north, east, down from the origin, m.
        velocity: in `is_body` forward, right, down, else north, east, down, m/s.
        is_body: whether the velocity turns with the vehicle.
        yaw: clockwise from north, rad.
        rate: yaw rate to the right, rad/s.
    """

    position: _Partial
    velocity: _Partial
    is_body: bool
    yaw: float | None
    rate: float


class SetpointError(ValueError):
    """A message has no valid setpoint; the text says why."""


def setpoint_of(message: MavlinkMessage, place: Place, home: Triple, now: Motion) -> Setpoint:
    """Read SET_POSITION_TARGET_LOCAL_NED or SET_POSITION_TARGET_GLOBAL_INT.

    Args:
        message: what has arrived.
        place: of the vehicle.
        home: position of home in the world, m.
        now: the motion of the vehicle.

    Raises:
        SetpointError: the frame is not supported, or a number is too large.
    """
    mask, frame = message.type_mask, message.coordinate_frame
    velocity = _numbers(mask >> 3, message.vx, message.vy, message.vz)
    is_body = False
    if message.get_type() == "SET_POSITION_TARGET_GLOBAL_INT":
        if frame not in (*_SEA, *_HOME):
            raise SetpointError(f"the frame {frame} of a global target is not supported, only 0, 3, 5 and 6")
        position: _Partial = (None, None, None)
        if not mask & 0b111:
            altitude = message.alt + (place.earth(home)[2] if frame in _HOME else 0.0)
            if not abs(altitude) < _FARTHEST:
                raise SetpointError("a target has no finite altitude")
            position = place.local(place.from_earth(message.lat_int * 1e-7, message.lon_int * 1e-7, altitude))
    else:
        position = _numbers(mask, message.x, message.y, message.z)
        is_body = frame in _BODY
        if frame == _LOCAL_OFFSET or is_body:
            north, east, down = place.local(now.position)
            if is_body and None not in position[:2]:
                heading = place.heading(now.yaw)
                c, s = math.cos(heading), math.sin(heading)
                x, y, z = position
                position = c * x - s * y, s * x + c * y, z  # type: ignore[operator]
            position = tuple(  # type: ignore[assignment]
                None if new is None else old + new for old, new in zip((north, east, down), position, strict=True)
            )
        elif frame != _LOCAL_NED:
            raise SetpointError(f"the frame {frame} of a local target is not supported, only 1, 7, 8, 9 and 12")
    yaw = None if mask & _NO_YAW or not abs(message.yaw) < 1e3 else math.remainder(message.yaw, math.tau)
    rate = 0.0 if mask & _NO_YAW_RATE or not abs(message.yaw_rate) < 1e3 else message.yaw_rate
    if position == velocity == (None, None, None) and yaw is None and not rate:
        raise SetpointError("a target without a finite position, velocity or yaw has no effect")
    return Setpoint(position, velocity, is_body, yaw, rate)


def _numbers(mask: int, *values: float) -> _Partial:
    """The values that are said: NaN says nothing, as with PX4."""
    numbers = [None if mask >> axis & 1 or math.isnan(value) else value for axis, value in enumerate(values)]
    if any(value is not None and abs(value) > _FARTHEST for value in numbers):
        raise SetpointError("a target is too far away, or too fast")
    return numbers[0], numbers[1], numbers[2]
