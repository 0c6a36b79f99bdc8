"""The wire to an autopilot in the loop, such as PX4: the measurements of a tick in one message, and lockstep."""

from __future__ import annotations

import math
import random
from typing import TYPE_CHECKING, Protocol

from morse.core.kinds.turning import quaternion_of
from morse.mathutils.rotations import turn_back

if TYPE_CHECKING:
    from morse.core.interfaces import Carrier
    from morse.core.object import Object
    from morse.plugins.mavlink.axes import Place
    from morse.plugins.mavlink.framing import MavlinkMessage

_SECOND = 10**9
#: MAV_MODE_FLAG, MAV_STATE
_HIL, _ACTIVE = 32, 4
#: of HIL_ACTUATOR_CONTROLS
_LOCKSTEP = 1
_SET_INTERVAL, _STATE = 511, 115
_ACCEPTED, _UNSUPPORTED = 0, 3
#: International Standard Atmosphere: m, hPa at the sea, exponent
_STANDARD = (44330.77, 1013.25, 0.190263)
_GRAVITY = 9.80665
_I16 = 0x7FFF
#: bits of fields_updated
BITS = {
    "xacc": 0, "yacc": 1, "zacc": 2, "xgyro": 3, "ygyro": 4, "zgyro": 5, "xmag": 6, "ymag": 7, "zmag": 8,
    "abs_pressure": 9, "diff_pressure": 10, "pressure_alt": 11, "temperature": 12,
}  # fmt: skip
#: autopilots take a sensor for broken if its values do not change by 1e-6 in 100 measurements (DataValidator of PX4):
#: m/s^2, rad/s, gauss, hPa; far less than the noise of real ones
_DITHER = {
    **dict.fromkeys(("xacc", "yacc", "zacc"), 5e-3),
    **dict.fromkeys(("xgyro", "ygyro", "zgyro"), 5e-4),
    **dict.fromkeys(("xmag", "ymag", "zmag"), 5e-4),
    "abs_pressure": 5e-3,
    "diff_pressure": 5e-3,
}


class Sender(Protocol):
    """What sends the messages; see `morse.plugins.mavlink.vehicle.Vehicle`."""

    system: int
    kind: int
    autopilot: int
    robot: Object | Carrier

    def send(self, name: str, *values: object) -> None:
        """Send a message."""

    def complain(self, kind: str, text: str) -> None:
        """Log a problem of a client."""


class Loop:
    """Speaks with an autopilot in the loop.

    Args:
        vehicle: sends the messages.
        place: its frame.

    Attributes:
        is_waiting: whether an autopilot in lockstep has not yet answered the measurements of the last tick.
    """

    def __init__(self, vehicle: Sender, place: Place) -> None:
        self._vehicle, self._place = vehicle, place
        self._next_heartbeat = 0
        self._in_step = self.is_waiting = False
        #: ns; None if nobody has asked for the true state
        self._interval: int | None = None
        self._next_state = 0

    def take(self, message: MavlinkMessage) -> None:
        """HIL_ACTUATOR_CONTROLS keeps the step; MAV_CMD_SET_MESSAGE_INTERVAL asks for HIL_STATE_QUATERNION."""
        kind = message.get_type()
        if kind == "HIL_ACTUATOR_CONTROLS":
            self._in_step, self.is_waiting = bool(message.flags & _LOCKSTEP), False
        elif kind == "COMMAND_LONG":
            is_state = message.command == _SET_INTERVAL and message.param1 == _STATE
            result = _ACCEPTED if is_state and self._ask(message.param2) else _UNSUPPORTED
            sender = message.get_srcSystem(), message.get_srcComponent()
            self._vehicle.send("command_ack", message.command, result, 0, 0, *sender)

    def _ask(self, interval: float) -> bool:
        if not -1.0 <= interval < 1e12:
            return False
        self._interval, self._next_state = (None if interval < 0.0 else round(interval * 1000.0)), 0
        return True

    def lose_step(self) -> None:
        """Do not wait any more, until controls arrive again."""
        self._vehicle.complain("lockstep", "the autopilot did not answer a tick; the simulation goes on without it")
        self._in_step = self.is_waiting = False

    def greet(self) -> None:
        """Send the next heartbeat at the end of the tick."""
        self._next_heartbeat = 0

    def tick(self, stamp: int, readings: dict[str, float]) -> None:
        """The end of a tick.

        Args:
            stamp: simulated time, ns.
            readings: measurements of the tick, as HIL_SENSOR has them.
        """
        self.is_waiting = bool(readings) and self._in_step
        interval = self._interval
        if interval is not None and (stamp >= self._next_state or stamp < self._next_state - interval):
            self._next_state = stamp + interval
            self._send_state(stamp, readings)
        if readings:
            self._send_sensors(stamp, readings)
        if stamp >= self._next_heartbeat or stamp < self._next_heartbeat - _SECOND:
            self._next_heartbeat = stamp + _SECOND
            self._vehicle.send("heartbeat", self._vehicle.kind, self._vehicle.autopilot, _HIL, 0, _ACTIVE)

    def _send_sensors(self, stamp: int, readings: dict[str, float]) -> None:
        # by the time: a run that is restored sends the same bits
        chance = random.Random(stamp << 8 | self._vehicle.system)
        shown = {name: value + _DITHER.get(name, 0.0) * chance.uniform(-1.0, 1.0) for name, value in readings.items()}
        if "abs_pressure" in shown:
            # PX4 takes a pressure only together with its altitude and a temperature
            altitude = _STANDARD[0] * (1.0 - (max(shown["abs_pressure"], 0.0) / _STANDARD[1]) ** _STANDARD[2])
            shown = {"pressure_alt": altitude, "temperature": 15.0 - 0.0065 * altitude, **shown}
        bits = sum(1 << BITS[name] for name in shown)
        self._vehicle.send("hil_sensor", stamp // 1000, *(shown.get(name, 0.0) for name in BITS), bits)

    def _send_state(self, stamp: int, readings: dict[str, float]) -> None:
        """HIL_STATE_QUATERNION: the truth, for logs."""
        axes, body = self._place.axes, self._vehicle.robot.bge_object
        (x, y, z), rotation = body.world_pose()
        linear, angular = body.velocity()
        latitude, longitude, altitude = self._place.earth((float(x), float(y), float(z)))
        angles = axes.angles_of(tuple(rotation))  # type: ignore[arg-type]
        speeds = [_whole(100.0 * v) for v in axes.vector(linear)]
        speed = min(round(100.0 * math.hypot(*(float(v) for v in linear))), 0xFFFF)
        felt = [_whole(1000.0 * readings.get(name, 0.0) / _GRAVITY) for name in ("xacc", "yacc", "zacc")]
        self._vehicle.send(
            "hil_state_quaternion", stamp // 1000, list(quaternion_of(*angles)),
            *axes.body(turn_back(rotation, angular)), round(latitude * 1e7), round(longitude * 1e7),
            max(-(1 << 31), min(round(altitude * 1e3), (1 << 31) - 1)), *speeds, speed, speed, *felt,
        )  # fmt: skip


def _whole(value: float) -> int:
    return max(-_I16, min(round(value), _I16))
