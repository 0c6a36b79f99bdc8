"""Inertial, magnetic and weather sensors, satellites, batteries, distances."""

from __future__ import annotations

import math
from datetime import UTC, datetime
from typing import TYPE_CHECKING, Any

import numpy as np

from morse.rosmsgs.parts import ABSENT, covariance, header, quaternion, xyz
from morse.rosmsgs.table import Inlet, Outlet, TopicTable, topics

if TYPE_CHECKING:
    from morse.core.kinds import BoundKind, Message
    from morse.core.values import RosMessage
    from morse.rosmsgs.table import Carrier

_NAN = math.nan
_PLACE = ("latitude", "longitude", "altitude")
#: constants of sensor_msgs/BatteryState, sensor_msgs/Range and sensor_msgs/NavSatFix
_STATUS = {"unknown": 0, "charging": 1, "discharging": 2, "full": 4}
_RADIATION = {"ultrasound": 0, "infrared": 1, "radar": 1}
_FIX, _GPS, _UNKNOWN, _DIAGONAL, _KNOWN = 0, 1, 0, 2, 3


class SensingKinds(TopicTable):
    """The kinds imu, magnetic_field, fix, pressure, temperature, battery and range."""

    @topics("imu")
    def imu(self, stream: Carrier, bound: BoundKind) -> list[Outlet]:
        """On ``data``, as in REP 145."""
        return [Outlet("sensor_msgs/msg/Imu", _imu, "data", is_detached=True, by_rows=True)]

    @topics("magnetic_field")
    def magnetic_field(self, stream: Carrier, bound: BoundKind) -> list[Outlet]:
        """On ``mag`` beside an imu."""
        beside = any(other.kind.name == "imu" for other in stream.kinds)
        return [
            Outlet(
                "sensor_msgs/msg/MagneticField",
                _magnetic_field,
                "mag" if beside else "",
                is_detached=True,
                by_rows=True,
            )
        ]

    @topics("fix")
    def fix(self, stream: Carrier, bound: BoundKind) -> list[Outlet]:
        """Of the antenna; velocity and universal time have their own topics."""
        outlets = [Outlet("sensor_msgs/msg/NavSatFix", _fix, frame="own", by_rows=True)]
        if bound.has("velocity"):
            outlets.append(Outlet("geometry_msgs/msg/TwistStamped", _ground_velocity, "vel", frame="enu", by_rows=True))
        if bound.has("utc"):
            outlets.append(Outlet("sensor_msgs/msg/TimeReference", _time_reference, "time_reference", frame="own"))
        return outlets

    @topics("fix", direction="IN")
    def take_fix(self, stream: Carrier, bound: BoundKind) -> list[Inlet]:
        """A target position."""
        return [Inlet("sensor_msgs/msg/NavSatFix", lambda m: {name: m[name] for name in _PLACE})]

    @topics("pressure")
    def pressure(self, stream: Carrier, bound: BoundKind) -> list[Outlet]:
        """A ``FluidPressure`` is absolute: the differential pressure is a number."""
        outlets = []
        if bound.has("absolute"):
            outlets.append(Outlet("sensor_msgs/msg/FluidPressure", _pressure, by_rows=True))
        if bound.has("differential"):
            outlets.append(
                Outlet("std_msgs/msg/Float64", lambda m, f: {"data": m.differential}, "differential", by_rows=True)
            )
        return outlets

    @topics("temperature")
    def temperature(self, stream: Carrier, bound: BoundKind) -> list[Outlet]:
        """In degrees Celsius."""
        return [
            Outlet(
                "sensor_msgs/msg/Temperature",
                lambda m, f: {"header": header(m, f), "temperature": m.temperature, "variance": m.variance},
                by_rows=True,
            )
        ]

    @topics("battery")
    def battery(self, stream: Carrier, bound: BoundKind) -> list[Outlet]:
        """Quantities that are not measured are NaN."""
        return [Outlet("sensor_msgs/msg/BatteryState", _battery, by_rows=True)]

    @topics("range")
    def range(self, stream: Carrier, bound: BoundKind) -> list[Outlet]:
        """Along the X axis of the frame: the frame of an altimeter points down, however the robot is tilted."""
        bundle = getattr(bound.component, "rays", None)
        return [
            Outlet(
                "sensor_msgs/msg/Range", _range, frame="down" if getattr(bundle, "upright", False) else "", by_rows=True
            )
        ]


def _imu(message: Message, frame: str) -> RosMessage:
    has_orientation = message.orientation is not None
    return {
        "header": header(message, frame),
        "orientation": quaternion(message.orientation),
        "orientation_covariance": covariance(message.orientation_covariance) if has_orientation else ABSENT,
        "angular_velocity": xyz(message.angular_velocity),
        "angular_velocity_covariance": covariance(message.angular_velocity_covariance),
        "linear_acceleration": xyz(message.linear_acceleration),
        "linear_acceleration_covariance": covariance(message.linear_acceleration_covariance),
    }


def _magnetic_field(message: Message, frame: str) -> RosMessage:
    return {
        "header": header(message, frame),
        "magnetic_field": xyz(message.field),
        "magnetic_field_covariance": covariance(message.covariance),
    }


def _fix(message: Message, frame: str) -> RosMessage:
    return {
        "header": header(message, frame),
        "status": {"status": _FIX, "service": _GPS},
        "latitude": message.latitude,
        "longitude": message.longitude,
        "altitude": message.altitude,
        "position_covariance": covariance(message.covariance),
        "position_covariance_type": _covariance_type(message.covariance),
    }


def _covariance_type(matrix: Any) -> int:
    if matrix is None or not np.any(matrix):
        return _UNKNOWN
    if matrix.ndim > 2:
        raise TypeError("the type of a covariance is found message by message")
    return _KNOWN if np.any(matrix - np.diag(np.diagonal(matrix))) else _DIAGONAL


def _ground_velocity(message: Message, frame: str) -> RosMessage | None:
    if message.velocity is None:
        return None
    return {"header": header(message, frame), "twist": {"linear": xyz(message.velocity)}}


def _time_reference(message: Message, frame: str) -> RosMessage | None:
    try:
        moment = datetime.fromisoformat(message.utc)
    except (TypeError, ValueError):
        return None  # no time from satellites
    moment = moment.replace(tzinfo=moment.tzinfo or UTC)
    seconds = math.floor(moment.timestamp())
    reference = {"sec": seconds, "nanosec": moment.microsecond * 1000}
    return {"header": header(message, frame), "time_ref": reference, "source": "GPS"}


def _pressure(message: Message, frame: str) -> RosMessage:
    return {"header": header(message, frame), "fluid_pressure": message.absolute, "variance": message.variance}


def _or_nan(value: float | None) -> float:
    return _NAN if value is None else value


def _battery(message: Message, frame: str) -> RosMessage:
    return {
        "header": header(message, frame),
        "percentage": message.charge,
        "power_supply_status": _STATUS.get(message.status, 0),
        "present": True,
        "voltage": _or_nan(message.voltage),
        "current": _or_nan(message.current),
        "temperature": _or_nan(message.temperature),
        "charge": _NAN,
        "capacity": _NAN,
        "design_capacity": _NAN,
    }


def _range(message: Message, frame: str) -> RosMessage:
    return {
        "header": header(message, frame),
        "radiation_type": _RADIATION.get(message.radiation, 1),
        "field_of_view": message.fov,
        "min_range": message.min,
        "max_range": message.max,
        "range": message.distance,
        "variance": message.variance,
    }
