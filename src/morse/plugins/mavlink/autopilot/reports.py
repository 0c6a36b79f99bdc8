"""What a vehicle says about itself, at intervals in simulated time."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, ClassVar

from morse.core.kinds.turning import quaternion_of
from morse.mathutils.rotations import turn_back
from morse.plugins.mavlink.autopilot.failsafe import NO_BREACH
from morse.plugins.mavlink.telemetry import boot_ms

if TYPE_CHECKING:
    from collections.abc import Callable

    from morse.plugins.mavlink.autopilot.flight import Flight
    from morse.plugins.mavlink.vehicle import Vehicle

_SECOND = 10**9
_U16, _U8, _I16 = 0xFFFF, 0xFF, 0x7FFF
_FIX_3D = 3
#: MAV_FRAME; MAV_ESTIMATOR_TYPE: the pose is known exactly
_LOCAL_NED, _BODY_FRD, _ESTIMATOR_MOCAP = 1, 12, 7
#: MAV_SYS_STATUS_SENSOR: inertial, magnetic, pressure, satellites; controls of rates, attitude, yaw, height, position;
#: motors, estimator, battery; may be armed
_SENSORS = 0b101111 | 0b111111 << 10 | 1 << 21 | 1 << 25 | 1 << 28
_FENCE = 1 << 20
#: MAV_PROTOCOL_CAPABILITY: float missions, whole numbers in missions, commands with whole numbers, bytes of parameters,
#: files, attitudes, positions in the local frame and on the earth, MAVLink 2, fences
_CAPABILITIES = 1 | 4 | 8 | 16 | 32 | 64 | 128 | 256 | 8192 | 16384
#: 1.14.0, a release: ground stations look for features by the version of PX4
_VERSION = 0x010E00FF


class Reports:
    """Messages that the autopilot sends; one that a sensor on the link sends is left to the sensor.

    Args:
        vehicle: sends them.
        flight: the state of the vehicle.
    """

    def __init__(self, vehicle: Vehicle, flight: Flight) -> None:
        self._vehicle, self._flight = vehicle, flight
        #: ns
        self._intervals = {name: round(_SECOND / rate) for name, (rate, _) in self._MESSAGES.items() if rate}
        self._due = dict.fromkeys(self._intervals, 0)
        self._stamp = 0

    def tick(self, stamp: int) -> None:
        """Send what is due at a simulated time, ns."""
        if stamp < self._stamp:
            self._due = dict.fromkeys(self._intervals, 0)
        self._stamp = stamp
        due = self._due
        for name, at in due.items():
            if at <= stamp:
                interval = self._intervals[name]
                due[name] = at + interval if at + interval > stamp else stamp + interval
                if name.lower() not in self._vehicle.measured:
                    self._MESSAGES[name][1](self)

    def request(self, name: str) -> bool:
        """Send a message at the end of the tick."""
        self._vehicle.after_tick.append(lambda: self._MESSAGES[name][1](self))
        return True

    def _name_of(self, number: float) -> str | None:
        name = self._vehicle.name_of(int(number)) if 0.0 <= number < 1 << 24 else None
        return name if name in self._MESSAGES else None

    def request_number(self, number: float) -> bool:
        """Send the message of a number; False if there is none."""
        name = self._name_of(number)
        return name is not None and self.request(name)

    def set_interval(self, number: float, interval: float) -> bool:
        """Set the interval of a message, us; 0 for the default, -1 for never. False if there is no such message."""
        name = self._name_of(number)
        if name is None or not -1.0 <= interval < 1e12:
            return False
        rate = self._MESSAGES[name][0]
        if interval < 0.0 or (interval == 0.0 and not rate):
            self._intervals.pop(name, None)
            self._due.pop(name, None)
        else:
            self._intervals[name] = max(1, round(interval * 1000.0) if interval else round(_SECOND / rate))
            self._due[name] = self._stamp
        return True

    def tell_interval(self, number: float) -> None:
        """Send MESSAGE_INTERVAL: us, -1 if a message is not sent, 0 if there is no such message."""
        name = self._name_of(number)
        interval = 0 if name is None else self._intervals.get(name, -1000) // 1000
        self._vehicle.send("message_interval", int(number) & 0xFFFF if abs(number) < 1e9 else 0, interval)

    # -- messages ----------------------------------------------------------------------------

    def _heartbeat(self) -> None:
        flight, active, standby = self._flight, 4, 3
        # those of cameras just before: MAVSDK's follow_me takes the mode from the heartbeat of any component
        flight.cameras.beat()
        state = active if flight.is_armed or flight.helm is None else standby
        kind = self._vehicle.kind
        self._vehicle.send(
            "heartbeat", kind, self._vehicle.autopilot, flight.mode.base(flight.is_armed), flight.mode.custom, state
        )

    def _sys_status(self) -> None:
        volts, current, left = self._vehicle.battery
        is_fenced, is_inside = bool(self._flight.fence.items), self._flight.failsafe.breach == NO_BREACH
        bits = _SENSORS | _FENCE, _SENSORS | _FENCE * is_fenced, _SENSORS | _FENCE * is_inside
        self._vehicle.send("sys_status", *bits, 0, volts, current, left, 0, 0, 0, 0, 0, 0)

    def _extended_sys_state(self) -> None:
        self._vehicle.send("extended_sys_state", 0, self._flight.landed)

    def _angles(self) -> tuple[float, float, float]:
        return self._flight.place.axes.angles_of(self._flight.now.rotation)

    def _attitude(self) -> None:
        flight = self._flight
        rates = flight.place.axes.body(flight.turn_rates())
        self._vehicle.send("attitude", boot_ms(self._stamp), *self._angles(), *rates)

    def _velocity(self) -> tuple[float, float, float]:
        return self._flight.place.axes.vector(self._flight.now.velocity)

    def _local_position(self) -> None:
        flight = self._flight
        position = flight.place.local(flight.now.position)
        self._vehicle.send("local_position_ned", boot_ms(self._stamp), *position, *self._velocity())

    def _earth(self) -> tuple[int, int, int]:
        latitude, longitude, altitude = self._flight.place.earth(self._flight.now.position)
        return _degrees(latitude), _degrees(longitude), _millimetres(altitude)

    def _course(self) -> tuple[int, int]:
        """Speed over ground, cm/s, and its direction, 0.01 degrees."""
        north, east, _ = self._velocity()
        return min(round(100.0 * math.hypot(north, east)), _U16 - 1), _heading(math.atan2(east, north))

    def _global_position(self) -> None:
        latitude, longitude, altitude = self._earth()
        height = self._flight.now.position[2] - self._flight.home[2]
        speeds = [max(-_I16, min(round(100.0 * v), _I16)) for v in self._velocity()]
        self._vehicle.send(
            "global_position_int", boot_ms(self._stamp), latitude, longitude, altitude, _millimetres(height), *speeds,
            _heading(self._angles()[2]),
        )  # fmt: skip

    def _gps(self) -> None:
        place = self._earth()
        self._vehicle.send(
            "gps_raw_int", self._stamp // 1000, _FIX_3D, *place, _U16, _U16, *self._course(), _U8, place[2]
        )

    def _home(self) -> None:
        flight = self._flight
        latitude, longitude, altitude = flight.place.earth(flight.home)
        nan = math.nan
        self._vehicle.send(
            "home_position", _degrees(latitude), _degrees(longitude), _millimetres(altitude),
            *flight.place.local(flight.home), [1.0, 0.0, 0.0, 0.0], nan, nan, nan, self._stamp // 1000,
        )  # fmt: skip

    def _origin(self) -> None:
        flight = self._flight
        latitude, longitude, altitude = flight.place.earth(flight.place.origin)
        self._vehicle.send(
            "gps_global_origin", _degrees(latitude), _degrees(longitude), _millimetres(altitude), self._stamp // 1000
        )

    def _hud(self) -> None:
        flight = self._flight
        x, y, z = flight.now.velocity
        flat, altitude = math.hypot(x, y), flight.place.earth(flight.now.position)[2]
        heading = _heading(self._angles()[2]) // 100
        throttle = 50 if flight.is_armed else 0
        self._vehicle.send("vfr_hud", math.hypot(flat, z), flat, heading, throttle, altitude, z)

    def _battery(self) -> None:
        # what has no battery does not run out of it
        self._vehicle.send("battery_status", 0, 0, 0, _I16, [_U16] * 10, -1, -1, -1, self._vehicle.battery[2], 0, 1)

    def _mission(self) -> None:
        self._flight.mission.tell()

    def _time(self) -> None:
        self._vehicle.send("system_time", 0, boot_ms(self._stamp))

    def _attitude_quaternion(self) -> None:
        flight = self._flight
        rates = flight.place.axes.body(flight.turn_rates())
        self._vehicle.send("attitude_quaternion", boot_ms(self._stamp), *quaternion_of(*self._angles()), *rates)

    def _odometry(self) -> None:
        flight, unknown = self._flight, [math.nan] + [0.0] * 20
        axes = flight.place.axes
        velocity = axes.body(turn_back(flight.now.rotation, flight.now.velocity))
        self._vehicle.send(
            "odometry", self._stamp // 1000, _LOCAL_NED, _BODY_FRD, *flight.place.local(flight.now.position),
            list(quaternion_of(*self._angles())), *velocity, *axes.body(flight.turn_rates()), unknown, unknown, 0,
            _ESTIMATOR_MOCAP, 100,
        )  # fmt: skip

    def _altitude(self) -> None:
        flight = self._flight
        z, altitude = flight.now.position[2], flight.place.earth(flight.now.position)[2]
        local, nan = z - flight.place.origin[2], math.nan
        self._vehicle.send("altitude", self._stamp // 1000, local, altitude, local, z - flight.home[2], nan, nan)

    def _fence_status(self) -> None:
        one = self._flight.failsafe
        time = boot_ms(one.breach_time)
        self._vehicle.send("fence_status", int(one.breach != 0), min(one.breaches, _U16), one.breach, time)

    def _version(self) -> None:
        system = self._vehicle.system
        empty = [0] * 8
        self._vehicle.send("autopilot_version", _CAPABILITIES, _VERSION, 0, 0, 0, empty, empty, empty, 0, 0, system)

    #: rate, Hz, 0 for those that are sent on request only
    _MESSAGES: ClassVar[dict[str, tuple[float, Callable[[Reports], None]]]] = {
        "HEARTBEAT": (1.0, _heartbeat),
        "SYS_STATUS": (1.0, _sys_status),
        "EXTENDED_SYS_STATE": (2.0, _extended_sys_state),
        "ATTITUDE": (20.0, _attitude),
        "LOCAL_POSITION_NED": (20.0, _local_position),
        "GLOBAL_POSITION_INT": (10.0, _global_position),
        "GPS_RAW_INT": (5.0, _gps),
        "HOME_POSITION": (0.5, _home),
        "VFR_HUD": (4.0, _hud),
        "BATTERY_STATUS": (0.5, _battery),
        "MISSION_CURRENT": (1.0, _mission),
        "SYSTEM_TIME": (1.0, _time),
        "AUTOPILOT_VERSION": (0.0, _version),
        "ATTITUDE_QUATERNION": (0.0, _attitude_quaternion),
        "ODOMETRY": (0.0, _odometry),
        "ALTITUDE": (0.0, _altitude),
        "FENCE_STATUS": (0.0, _fence_status),
        "GPS_GLOBAL_ORIGIN": (0.0, _origin),
    }


def _degrees(angle: float) -> int:
    return round(angle * 1e7)


def _millimetres(length: float) -> int:
    return max(-(1 << 31), min(round(length * 1000.0), (1 << 31) - 1))


def _heading(angle: float) -> int:
    """0.01 degrees clockwise from north."""
    return round(math.degrees(angle) * 100.0) % 36000
