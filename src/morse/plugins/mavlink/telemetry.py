"""Messages of sensors."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from morse.core.kinds.turning import quaternion_of
from morse.core.mapping import maps
from morse.mathutils.rotations import nine, product, quaternion_from_rotation, rotation_from_quaternion, turn

if TYPE_CHECKING:
    from collections.abc import Iterable

    from morse.core.kinds import Message
    from morse.plugins.mavlink.axes import Axes
    from morse.plugins.mavlink.vehicle import MavlinkStream

_NAN = math.nan
_GAUSS, _HECTOPASCAL = 1e4, 1e-2
_U16, _I16, _U8 = 0xFFFF, 0x7FFF, 0xFF
_FIX_3D = 3
#: dilution of precision, 0.01, of a good fix, horizontally and vertically; number of satellites
_ACCURACY, _SEEN = (90, 110), 12
#: names of frames in ODOMETRY: a local one with X forward, Y right, Z down; the vehicle
_LOCAL_FRD, _BODY_FRD = 20, 12
_RADIATION = {"ultrasound": 1, "infrared": 2, "radar": 3}
_CHARGING, _FINE = 7, 1
#: orientation of a DISTANCE_SENSOR by the direction of its axis, X forward, Y left, Z up
_LOOKS = {0: (1.0, 0.0, 0.0), 2: (0.0, -1.0, 0.0), 4: (-1.0, 0.0, 0.0), 6: (0.0, 1.0, 0.0), 24: (0.0, 0.0, 1.0),
          25: (0.0, 0.0, -1.0)}  # fmt: skip
_DOWN = 25
_BINS = 72
#: sizes of NAMED_VALUE_FLOAT and DEBUG_FLOAT_ARRAY
_LETTERS, _MOST_VALUES = 10, 58
#: id of the gimbal, for one that is a part of the autopilot
_GIMBAL = 1
#: GIMBAL_DEVICE_FLAGS_YAW_IN_VEHICLE_FRAME
_IN_VEHICLE = 32
PAN_TILT = ("pan", "tilt")
_MOST_WHEELS = 16


def boot_ms(stamp: int) -> int:
    """``time_boot_ms``: 32 bits of the simulated time."""
    return stamp // 1_000_000 & 0xFFFFFFFF


def _whole(value: float, least: int, most: int, unknown: int) -> int:
    return min(max(round(value), least), most) if math.isfinite(value) else unknown


class Telemetry:
    """The part of the stream manager for sensors."""

    axes: dict[str, Axes]

    @maps("attitude")
    def attitude(self, stream: MavlinkStream, m: Message) -> None:
        """ATTITUDE."""
        axes = stream.axes_of(m.frame)
        roll, pitch, yaw = (_NAN,) * 3 if m.orientation is None else axes.angles(m.orientation)
        rates = (_NAN,) * 3 if m.rates is None else self.axes["nwu"].body(m.rates)
        stream.vehicle.measure("attitude", boot_ms(m.stamp), roll, pitch, yaw, *rates)

    @maps("odometry")
    def odometry(self, stream: MavlinkStream, m: Message) -> None:
        """LOCAL_POSITION_NED and ODOMETRY."""
        frd, axes = self.axes["nwu"], stream.axes_of(m.frame)
        position, orientation = m.position, m.orientation
        if axes.frame != "ned":
            # odometry is relative to the initial pose, LOCAL_POSITION_NED to the initial position
            rows = stream.component_instance.initial_position_3d.rotation_matrix
            start = nine([list(row) for row in rows])
            w, x, y, z = (float(number) for number in orientation)
            position = turn(start, [float(number) for number in position])
            orientation = quaternion_from_rotation(product(start, rotation_from_quaternion(w, x, y, z)))
        velocity = turn(axes.rotation(orientation), frd.body(m.linear))
        stream.vehicle.measure("local_position_ned", boot_ms(m.stamp), *axes.vector(position), *velocity)
        local = axes if axes.frame == "ned" else frd
        stream.vehicle.measure(
            "odometry", m.stamp // 1000, _LOCAL_FRD, _BODY_FRD, *local.vector(m.position),
            list(local.quaternion(m.orientation)), *frd.body(m.linear), *frd.body(m.angular),
            local.covariance(m.pose_covariance), frd.covariance(m.twist_covariance, of_body=True),
        )  # fmt: skip

    @maps("pose")
    def pose(self, stream: MavlinkStream, m: Message) -> None:
        """VISION_POSITION_ESTIMATE."""
        axes = stream.axes_of(m.frame)
        angles = (_NAN,) * 3 if m.orientation is None else axes.angles(m.orientation)
        stream.vehicle.measure(
            "vision_position_estimate", m.stamp // 1000, *axes.vector(m.position), *angles,
            axes.covariance(m.covariance),
        )  # fmt: skip

    @maps("imu")
    def imu(self, stream: MavlinkStream, m: Message) -> None:
        """A part of HIGHRES_IMU, or of HIL_SENSOR."""
        axes = stream.axes_of("ned" if m.frame == "frd" else "world")
        stream.vehicle.sense(**_named("acc", axes.body(m.linear_acceleration)))
        stream.vehicle.sense(**_named("gyro", axes.body(m.angular_velocity)))

    @maps("magnetic_field")
    def magnetic_field(self, stream: MavlinkStream, m: Message) -> None:
        """A part of HIGHRES_IMU, or of HIL_SENSOR; in gauss."""
        axes = stream.axes_of("ned" if m.frame == "frd" else "world")
        stream.vehicle.sense(**_named("mag", [number * _GAUSS for number in axes.body(m.field)]))

    @maps("pressure")
    def pressure(self, stream: MavlinkStream, m: Message) -> None:
        """SCALED_PRESSURE, or a part of HIL_SENSOR; in hectopascal."""
        absolute, differential = ((v or 0.0) * _HECTOPASCAL for v in (m.absolute, m.differential))
        if m.absolute is not None:
            stream.vehicle.sense(abs_pressure=absolute)
        if m.differential is not None:
            stream.vehicle.sense(diff_pressure=differential)
        if stream.vehicle.loop is None:
            stream.vehicle.measure("scaled_pressure", boot_ms(m.stamp), absolute, differential, 0)

    @maps("temperature")
    def temperature(self, stream: MavlinkStream, m: Message) -> None:
        """SCALED_PRESSURE without a pressure, or a part of HIL_SENSOR."""
        stream.vehicle.sense(temperature=m.temperature)
        if stream.vehicle.loop is None:
            centidegrees = _whole(m.temperature * 100.0, -_I16, _I16, 0)
            stream.vehicle.measure("scaled_pressure", boot_ms(m.stamp), _NAN, _NAN, centidegrees)

    @maps("fix")
    def fix(self, stream: MavlinkStream, m: Message) -> None:
        """GPS_RAW_INT, or HIL_GPS. The altitude is above the ellipsoid, without a geoid model."""
        lat, lon, alt = round(m.latitude * 1e7), round(m.longitude * 1e7), round(m.altitude * 1e3)
        east, north, up = (0.0, 0.0, 0.0) if m.velocity is None else (100.0 * float(v) for v in m.velocity)
        speed = _U16 if m.velocity is None else _whole(math.hypot(east, north), 0, _U16 - 1, _U16)
        course = _U16 if m.course is None else _whole(m.course * 100.0, 0, 35999, _U16)
        time = m.stamp // 1000
        if stream.vehicle.loop is not None:
            velocity = (_whole(v, -_I16, _I16, 0) for v in (north, east, -up))
            # PX4 does not use a fix whose accuracy is unknown
            stream.vehicle.measure("hil_gps", time, _FIX_3D, lat, lon, alt, *_ACCURACY, speed, *velocity, course, _SEEN)
        else:
            stream.vehicle.measure("gps_raw_int", time, _FIX_3D, lat, lon, alt, _U16, _U16, speed, course, _U8, alt)

    @maps("battery")
    def battery(self, stream: MavlinkStream, m: Message) -> None:
        """BATTERY_STATUS, and a part of SYS_STATUS."""
        charge = _whole(m.charge * 100.0, 0, 100, -1)
        warm = _I16 if m.temperature is None else _whole(m.temperature * 100.0, -_I16, _I16 - 1, _I16)
        volts = _U16 if m.voltage is None else _whole(m.voltage * 1000.0, 0, _U16 - 1, _U16)
        # positive while it discharges
        current = -1 if m.current is None else _whole(-m.current * 100.0, -_I16, _I16, -1)
        state = _CHARGING if m.status == "charging" else _FINE
        stream.vehicle.measure(
            "battery_status", stream.number(stream.kinds[0]), 0, 0, warm, [volts] + [_U16] * 9, current, -1, -1, charge,
            0, state,
        )  # fmt: skip
        stream.vehicle.battery = volts, current, charge

    @maps("range")
    def range(self, stream: MavlinkStream, m: Message) -> None:
        """DISTANCE_SENSOR, in centimetres."""
        if math.isnan(m.distance):
            return  # an invalid distance is neither near nor far
        least, most = (_whole(v * 100.0, 0, _U16 - 2, _U16 - 2) for v in (m.min, m.max))
        far = most + 1
        near = max(0, least - 1)
        distance = near if m.distance == -math.inf else _whole(m.distance * 100.0, 0, far, far)
        stream.vehicle.measure(
            "distance_sensor", boot_ms(m.stamp), least, most, distance, _RADIATION.get(m.radiation, 0),
            stream.number(stream.kinds[0]), _DOWN if m.radiation == "radar" else _looks(stream), _U8, m.fov, m.fov,
        )  # fmt: skip

    @maps("scan")
    def scan(self, stream: MavlinkStream, m: Message) -> None:
        """OBSTACLE_DISTANCE: the nearest obstacle in each of 72 directions, clockwise from ahead, in centimetres."""
        mounting = stream.component_instance.sensor_to_robot_position_3d()
        angles = m.angle_min + np.arange(len(m.ranges)) * m.angle_increment + mounting.yaw
        directions = np.rint(np.degrees(-angles) / (360.0 / _BINS)).astype(int) % _BINS
        least, most = (_whole(v * 100.0, 0, _U16 - 2, _U16 - 2) for v in (m.range_min, m.range_max))
        valid = ~np.isnan(m.ranges)
        distances = np.clip(np.nan_to_num(m.ranges.astype(float) * 100.0), least, most + 1)
        bins = np.full(_BINS, _U16)
        np.minimum.at(bins, directions[valid], np.rint(distances[valid]).astype(int))
        stream.vehicle.measure(
            "obstacle_distance", m.stamp // 1000, 0, bins.tolist(), 0, least, most, 360.0 / _BINS, 0.0, _BODY_FRD
        )

    @maps("joints")
    def joints(self, stream: MavlinkStream, m: Message) -> None:
        """GIMBAL_DEVICE_ATTITUDE_STATUS of a pan-tilt unit, WHEEL_DISTANCE of wheels; others as numbers."""
        radii = getattr(stream.component_instance, "radii", None)
        if tuple(m.names) == PAN_TILT and m.position is not None:
            pan, tilt = (float(angle) for angle in m.position)
            # positive is to the left and downward; in MAVLink to the right and upward
            w, x, y, z = quaternion_of(0.0, -tilt, -pan)
            stream.vehicle.measure(
                "gimbal_device_attitude_status",
                0,
                0,
                boot_ms(m.stamp),
                _IN_VEHICLE,
                [w, x, y, z],
                _NAN,
                _NAN,
                _NAN,
                0,
                _NAN,
                _NAN,
                _GIMBAL,
            )
        elif radii is not None and m.position is not None:
            metres = [float(angle) * radius for angle, radius in zip(m.position, radii, strict=True)][:_MOST_WHEELS]
            distances = metres + [0.0] * (_MOST_WHEELS - len(metres))
            stream.vehicle.measure("wheel_distance", m.stamp // 1000, len(metres), distances)
        else:
            self.general(stream, m)

    @maps("clock")
    def clock(self, stream: MavlinkStream, m: Message) -> None:
        """SYSTEM_TIME; a simulation has no universal time."""
        stream.vehicle.measure("system_time", 0, boot_ms(m.stamp))

    @maps("general")
    def general(self, stream: MavlinkStream, m: Message) -> None:
        """Every number as a message, and lists of numbers; other values have no message."""
        for name, value in m.fields.items():
            if name == "timestamp":
                continue
            label = name.encode("ascii", "replace")[:_LETTERS]
            if isinstance(value, (bool, int)) and abs(value) < 1 << 31:
                stream.vehicle.measure("named_value_int", boot_ms(m.stamp), label, int(value))
            elif isinstance(value, (int, float)):
                stream.vehicle.measure("named_value_float", boot_ms(m.stamp), label, float(value))
            else:
                values = _numbers(value)
                if values is not None:
                    number = stream.number(stream.kinds[0])
                    stream.vehicle.measure("debug_float_array", m.stamp // 1000, label, number, values)


def _named(what: str, vector: Iterable[float]) -> dict[str, float]:
    return {f"{axis}{what}": float(value) for axis, value in zip("xyz", vector, strict=True)}


def _looks(stream: MavlinkStream) -> int:
    """The direction of a sensor on its robot."""
    rows = stream.component_instance.sensor_to_robot_position_3d().rotation_matrix
    ahead = [row[0] for row in rows]
    return max(_LOOKS, key=lambda name: sum(a * b for a, b in zip(_LOOKS[name], ahead, strict=True)))


def _numbers(value: object) -> list[float] | None:
    """58 numbers of a list of numbers; None for other values."""
    if isinstance(value, (str, bytes, dict)) or not hasattr(value, "__iter__"):
        return None
    try:
        array = np.asarray(list(value), dtype=float).reshape(-1)[:_MOST_VALUES]
    except (TypeError, ValueError):
        return None
    return [*array.tolist(), *[0.0] * (_MOST_VALUES - len(array))]
