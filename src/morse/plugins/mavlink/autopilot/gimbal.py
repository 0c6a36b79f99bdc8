"""The gimbal of a vehicle: a pan-tilt unit whose actuator is on the link."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from morse.mathutils.rotations import turn_back
from morse.plugins.mavlink.telemetry import PAN_TILT, boot_ms

if TYPE_CHECKING:
    from morse.core.kinds import BoundKind
    from morse.mathutils.rotations import Triple
    from morse.plugins.mavlink.autopilot.modes import Craft
    from morse.plugins.mavlink.vehicle import MavlinkStream, Vehicle

_INFORMATION, _STATUS, _DEVICE_INFORMATION = 280, 281, 283
_SECOND = 10**9
#: GIMBAL_MANAGER_CAP_FLAGS: tilts, pans, and its pan follows the vehicle
_CAN = 8 | 16 | 32 | 256 | 512
#: the first of the ids for gimbals that are a part of the autopilot
_DEVICE = 1
#: GIMBAL_MANAGER_FLAGS_YAW_IN_VEHICLE_FRAME
_IN_VEHICLE = 32
#: rad/s
_FASTEST = 100.0


class Gimbal:
    """Answers as a gimbal manager."""

    def __init__(self, vehicle: Vehicle, flight: Craft) -> None:
        self._vehicle, self._flight = vehicle, flight
        self._stamp = 0
        #: rad/s upward and to the right; a place to look at, m in the world; who controls it: system and component
        self._rates = (0.0, 0.0)
        self._place: Triple | None = None
        self._control = (0, 0)

    def _find(self) -> tuple[MavlinkStream, BoundKind] | None:
        for stream in self._vehicle.streams:
            for bound in stream.kinds:
                if bound.kind.name == "joints" and tuple(bound.gather().names) == PAN_TILT:
                    return stream, bound
        return None

    @property
    def is_there(self) -> bool:
        """Whether the vehicle has one."""
        return self._find() is not None

    def look(self, pitch: float, yaw: float, pitch_rate: float = math.nan, yaw_rate: float = math.nan) -> bool:
        """Turn to angles upward and to the right, rad, or with rates, rad/s; NaN keeps them. False without a gimbal."""
        if math.isinf(pitch) or math.isinf(yaw) or not self._turn(pitch, yaw):
            return False
        self._place = None
        self._rates = (
            pitch_rate if math.isnan(pitch) and abs(pitch_rate) < _FASTEST else 0.0,
            yaw_rate if math.isnan(yaw) and abs(yaw_rate) < _FASTEST else 0.0,
        )
        return True

    def look_at(self, place: Triple | None) -> bool:
        """Look at a place in the world, m, from now on, or ahead. False without a gimbal."""
        self._rates, self._place = (0.0, 0.0), place
        return self.is_there if place is not None else self._turn(0.0, 0.0)

    def configure(self, params: tuple[float, ...], sender: tuple[int, int]) -> bool:
        """MAV_CMD_DO_GIMBAL_MANAGER_CONFIGURE: who controls the gimbal. False without a gimbal."""
        own, none = -2.0, -3.0
        if params[0] == own:
            self._control = sender
        elif params[0] == none:
            self._control = (0, 0)
        elif 0.0 <= params[0] <= 255.0 and 0.0 <= params[1] <= 255.0:
            self._control = int(params[0]), int(params[1])
        return self.is_there

    def _turn(self, pitch: float, yaw: float, *, adds: bool = False) -> bool:
        """Command angles, or changes of them; NaN keeps an angle."""
        entry = self._find()
        if entry is None:
            return False
        stream, bound = entry
        present = (float(angle) for angle in bound.gather().position)
        target = (-yaw, -pitch)  # positive is to the left and downward
        angles = [
            old if math.isnan(new) else old + new if adds else new for old, new in zip(present, target, strict=True)
        ]
        stream.receive(bound, {"position": angles})
        return True

    def _aim(self, place: Triple) -> None:
        now = self._flight.now
        x, y, z = turn_back(now.rotation, [a - b for a, b in zip(place, now.position, strict=True)])
        self._turn(math.atan2(z, math.hypot(x, y)), -math.atan2(y, x))

    def request(self, number: float) -> bool:
        """Send the message of a number; False if it is not one of a gimbal."""
        if number not in (_INFORMATION, _STATUS, _DEVICE_INFORMATION) or not self.is_there:
            return False
        stamp = boot_ms(self._stamp)
        quarter = math.pi / 2.0
        limits = (0.0, 0.0, -quarter, quarter, -math.pi, math.pi)
        if number == _INFORMATION:
            self._vehicle.send("gimbal_manager_information", stamp, _CAN, _DEVICE, *limits)
        elif number == _DEVICE_INFORMATION:
            names = (b"MORSE", b"pan-tilt unit", b"")
            self._vehicle.send("gimbal_device_information", stamp, *names, 0, 0, 0, _CAN, 0, *limits, _DEVICE)
        else:
            self._vehicle.send("gimbal_manager_status", stamp, _IN_VEHICLE, _DEVICE, *self._control, 0, 0)
        return True

    def tick(self, stamp: int) -> None:
        """Turn, and send the status once in a second of simulated time, ns."""
        if stamp // _SECOND != self._stamp // _SECOND:
            self.request(_STATUS)
        dt = max(0, stamp - self._stamp) / _SECOND
        self._stamp = stamp
        if self._place is not None:
            self._aim(self._place)
        elif self._rates != (0.0, 0.0):
            self._turn(self._rates[0] * dt, self._rates[1] * dt, adds=True)
