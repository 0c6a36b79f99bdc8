"""The parameters of a vehicle: names of PX4, so that ground stations and MAVSDK find what they look for."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from morse.middleware.mavlink.messages import MavlinkMessage
    from morse.middleware.mavlink.vehicle import Vehicle

#: MAV_PARAM_TYPE_REAL32. All parameters have it: the bytes of whole numbers differ between autopilots
_REAL32 = 9
#: number of parameters that are sent in a tick
_IN_A_TICK = 4


class Range(NamedTuple):
    """Default and limits of a parameter."""

    default: float
    low: float
    high: float


TABLE = {
    "MIS_TAKEOFF_ALT": Range(2.5, 0.1, 1e4),  # m above home
    "RTL_RETURN_ALT": Range(10.0, 0.0, 1e4),  # m above home
    "MPC_XY_CRUISE": Range(5.0, 0.1, 100.0),  # m/s, of aircraft
    "GND_SPEED_TRIM": Range(1.0, 0.05, 40.0),  # m/s, of all others
    "MPC_Z_VEL_MAX_UP": Range(3.0, 0.1, 50.0),  # m/s
    "MPC_Z_VEL_MAX_DN": Range(1.5, 0.1, 50.0),  # m/s
    "MPC_LAND_SPEED": Range(0.7, 0.1, 10.0),  # m/s
    "MPC_MAN_Y_MAX": Range(90.0, 1.0, 360.0),  # degrees per second, with MANUAL_CONTROL
    "NAV_ACC_RAD": Range(1.0, 0.05, 200.0),  # m
    "COM_DISARM_LAND": Range(2.0, 0.0, 60.0),  # s
    "COM_DL_LOSS_T": Range(10.0, 1.0, 300.0),  # s without a heartbeat of a ground station
    "NAV_DLL_ACT": Range(0.0, 0.0, 3.0),  # what follows: 0 nothing, 1 hold, 2 return, 3 land
}


class Parameters:
    """The values, and the parameter protocol."""

    def __init__(self, vehicle: Vehicle) -> None:
        self._vehicle = vehicle
        self._values = {name: entry.default for name, entry in TABLE.items()}
        self._listed: list[str] = []

    def __getitem__(self, name: str) -> float:
        return self._values[name]

    def set(self, name: str, value: float) -> None:
        """Set a value; one that is outside of its range changes nothing."""
        if math.isfinite(value) and TABLE[name].low <= value <= TABLE[name].high:
            self._values[name] = value

    def take(self, message: MavlinkMessage) -> None:
        """PARAM_REQUEST_LIST, PARAM_REQUEST_READ, PARAM_SET."""
        kind = message.get_type()
        if kind == "PARAM_REQUEST_LIST":
            self._listed = list(self._values)
            return
        index = getattr(message, "param_index", -1)
        names = list(self._values)
        name = names[index] if 0 <= index < len(names) else str(message.param_id)
        if name not in self._values:
            return
        if kind == "PARAM_SET" and message.param_type == _REAL32:
            self.set(name, message.param_value)
        # the answer to a value that was refused is the value that counts
        self._send(name)

    def tick(self) -> None:
        """Send the next parameters of a list."""
        for name in self._listed[:_IN_A_TICK]:
            self._send(name)
        del self._listed[:_IN_A_TICK]

    def _send(self, name: str) -> None:
        names = list(self._values)
        self._vehicle.send("param_value", name.encode(), self._values[name], _REAL32, len(names), names.index(name))
