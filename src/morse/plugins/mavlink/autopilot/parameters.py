"""The parameters of a vehicle: names of PX4, so that ground stations and MAVSDK find what they look for."""

from __future__ import annotations

import struct
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from morse.plugins.mavlink.framing import MavlinkMessage
    from morse.plugins.mavlink.vehicle import Vehicle

#: MAV_PARAM_TYPE
_INT32, _REAL32 = 6, 9
#: PARAM_ACK; MAV_PARAM_ERROR
_ACCEPTED, _UNSUPPORTED = 0, 1
_NOT_THERE, _OUT_OF_RANGE = 1, 2
#: number of parameters that are sent in a tick
_IN_A_TICK = 4


class Range(NamedTuple):
    """Default and limits of a parameter; whole numbers for those that PX4 has as INT32."""

    default: float
    low: float
    high: float

    @property
    def type(self) -> int:
        """MAV_PARAM_TYPE."""
        return _INT32 if isinstance(self.default, int) else _REAL32

    def pack(self, value: float) -> bytes:
        """The four bytes of a value in messages, as with PX4."""
        return struct.pack("<i", int(value)) if self.type == _INT32 else struct.pack("<f", value)


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
    "COM_DL_LOSS_T": Range(10, 1, 300),  # s without a heartbeat of a ground station
    "COM_OF_LOSS_T": Range(1.0, 0.0, 60.0),  # s without a setpoint in OFFBOARD
    # what follows: 0 position, 1 altitude, 2 manual, 3 return, 4 land, 5 hold, 6 terminate, 7 disarm
    "COM_OBL_RC_ACT": Range(0, 0, 7),
    "GF_ACTION": Range(2, 0, 5),  # outside the fence: 0 nothing, 1 warning, 2 hold, 3 return, 4 terminate, 5 land
    "GF_MAX_HOR_DIST": Range(0.0, 0.0, 1e5),  # m from home; 0: any
    "GF_MAX_VER_DIST": Range(0.0, 0.0, 1e5),  # m above home; 0: any
    "FLW_TGT_HT": Range(8.0, 0.1, 1e4),  # m above home, in the mode follow
    "FLW_TGT_DST": Range(8.0, 1.0, 1e3),  # m from the target
    "FLW_TGT_FA": Range(180.0, -180.0, 180.0),  # degrees clockwise from the course of the target
    "NAV_DLL_ACT": Range(0, 0, 3),  # what follows: 0 nothing, 1 hold, 2 return, 3 land
}


class Parameters:
    """The values, and the parameter protocol."""

    def __init__(self, vehicle: Vehicle) -> None:
        self._vehicle = vehicle
        self._values = {name: entry.default for name, entry in TABLE.items()}
        #: names, and whether the extended protocol has asked for them
        self._list: list[tuple[str, bool]] = []

    def __getitem__(self, name: str) -> float:
        return self._values[name]

    def set(self, name: str, value: float) -> bool:
        """Set a value; False for one that is outside of its range, or not whole, which changes nothing."""
        entry = TABLE[name]
        is_valid = entry.low <= value <= entry.high and (entry.type == _REAL32 or value == int(value))
        if is_valid:
            self._values[name] = value
        return is_valid

    def _set_bytes(self, name: str, raw: bytes, type_: int) -> bool:
        """Set a value as messages have it; a whole number may also come as REAL32."""
        value: float = struct.unpack("<i" if type_ == _INT32 else "<f", raw)[0]
        return type_ in (_REAL32, TABLE[name].type) and self.set(name, value)

    def take(self, message: MavlinkMessage) -> None:
        """PARAM_REQUEST_LIST, PARAM_REQUEST_READ, PARAM_SET, and the same of the extended protocol."""
        kind = message.get_type()
        is_extended = kind.startswith("PARAM_EXT")
        if kind.endswith("REQUEST_LIST"):
            self._list = [(name, is_extended) for name in self._values]
            return
        index = getattr(message, "param_index", -1)
        names = list(self._values)
        name = names[index] if 0 <= index < len(names) else str(message.param_id)
        if name not in self._values:
            self._refuse(message, name, is_extended)
        elif kind == "PARAM_EXT_SET":
            self._acknowledge(name, message)
        else:
            raw = b"" if kind != "PARAM_SET" else struct.pack("<f", message.param_value)
            if raw and not self._set_bytes(name, raw, message.param_type):
                self._say_error(message, name, _OUT_OF_RANGE)
            # the answer to a value that was refused is the value that counts
            self._send(name, is_extended)

    def _acknowledge(self, name: str, message: MavlinkMessage) -> None:
        """Set a value by PARAM_EXT_SET."""
        # pymavlink decodes the bytes of the value as text; zeros at the end are not sent
        raw = bytes(message._param_value_raw[:4]).ljust(4, b"\0")
        entry = TABLE[name]
        result = _ACCEPTED if self._set_bytes(name, raw, message.param_type) else _UNSUPPORTED
        self._vehicle.send("param_ext_ack", name.encode(), entry.pack(self._values[name]), entry.type, result)

    def _refuse(self, message: MavlinkMessage, name: str, is_extended: bool) -> None:
        """There is no such parameter."""
        identity = name.encode("utf-8", "replace")[:16]
        if message.get_type() == "PARAM_EXT_SET":
            self._vehicle.send("param_ext_ack", identity, b"", message.param_type, _UNSUPPORTED)
        elif not is_extended:
            self._say_error(message, name, _NOT_THERE)

    def _say_error(self, message: MavlinkMessage, name: str, error: int) -> None:
        """Send PARAM_ERROR, which newer ground stations wait for, and older versions of pymavlink lack."""
        if self._vehicle.knows("param_error"):
            sender = message.get_srcSystem(), message.get_srcComponent()
            identity = name.encode("utf-8", "replace")[:16]
            self._vehicle.send("param_error", *sender, identity, getattr(message, "param_index", -1), error)

    def tick(self) -> None:
        """Send the next parameters of a list."""
        for name, is_extended in self._list[:_IN_A_TICK]:
            self._send(name, is_extended)
        del self._list[:_IN_A_TICK]

    def _send(self, name: str, is_extended: bool = False) -> None:
        names = list(self._values)
        entry = TABLE[name]
        raw = entry.pack(self._values[name])
        message, value = ("param_ext_value", raw) if is_extended else ("param_value", *struct.unpack("<f", raw))
        self._vehicle.send(message, name.encode(), value, entry.type, len(names), names.index(name))
