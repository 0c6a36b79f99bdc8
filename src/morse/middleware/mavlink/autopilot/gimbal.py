"""The gimbal of a vehicle: a pan-tilt unit whose actuator is on the link."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from morse.middleware.mavlink.telemetry import PAN_TILT, boot_ms

if TYPE_CHECKING:
    from morse.core.kinds import BoundKind
    from morse.middleware.mavlink.stream import MavlinkStream
    from morse.middleware.mavlink.vehicle import Vehicle

_INFORMATION, _STATUS, _DEVICE_INFORMATION = 280, 281, 283
_SECOND = 10**9
#: GIMBAL_MANAGER_CAP_FLAGS: tilts, pans, and its pan follows the vehicle
_CAN = 8 | 16 | 32 | 256 | 512
#: the first of the ids for gimbals that are a part of the autopilot
_DEVICE = 1
#: GIMBAL_MANAGER_FLAGS_YAW_IN_VEHICLE_FRAME
_IN_VEHICLE = 32


class Gimbal:
    """Answers as a gimbal manager."""

    def __init__(self, vehicle: Vehicle) -> None:
        self._vehicle = vehicle
        self._stamp = 0

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

    def look(self, pitch: float, yaw: float) -> bool:
        """Turn upward and to the right, rad; NaN keeps an angle. False without a gimbal."""
        entry = self._find()
        if entry is None or math.isinf(pitch) or math.isinf(yaw):
            return False
        stream, bound = entry
        present = (float(angle) for angle in bound.gather().position)
        wanted = (-yaw, -pitch)  # positive is to the left and downward
        angles = [old if math.isnan(new) else new for old, new in zip(present, wanted, strict=True)]
        stream.receive(bound, {"position": angles})
        return True

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
            self._vehicle.send("gimbal_manager_status", stamp, _IN_VEHICLE, _DEVICE, 0, 0, 0, 0)
        return True

    def tick(self, stamp: int) -> None:
        """Send the status once in a second of simulated time, ns."""
        if stamp // _SECOND != self._stamp // _SECOND:
            self.request(_STATUS)
        self._stamp = stamp
