"""The names of variables, as in MORSE 1.4."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from morse.wire.encoding import written

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from morse.core.object import Object
    from morse.core.sensor import Sensor

    Value = float | str
    Variables = Iterator[tuple[str, Value]]

_AXES = "xyz"
#: variable, after the prefix, of each field of a component class; messages of these variables are numbers
_OF_SENSORS = {
    "GPS": {"x": "GPS_E_X", "y": "GPS_N_Y", "z": "GPS_ALT_Z"},
    "Gyroscope": {name: f"GYRO_{name.upper()}" for name in ("yaw", "roll", "pitch")},
    "Pose": {"timestamp": "TIME"} | {name: f"SIM_{name.upper()}" for name in (*_AXES, "yaw", "roll", "pitch")},
}
_MOTION = {"v": "VELOCITY", "w": "YAWRATE", "steer": "STEER", "force": "THROTTLE", "brake": "BRAKE"}
_OF_ACTUATORS = {
    "Light": {"LIGHT": "emit"},
    "Teleport": {f"SET_{name.upper()}": name for name in (*_AXES, "roll", "pitch", "yaw")},
    **{
        name: {f"MOTION_{word}": field for field, word in _MOTION.items()}
        for name in ("SteerForce", "MotionVW", "MotionVWDiff")
    },
}


def form_of(component: Object) -> Callable[[Any], Variables]:
    """Return the function that gives the variables of a sensor, without their prefix."""
    for cls in type(component).__mro__:
        if cls.__name__ in _OF_SENSORS and _OF_SENSORS[cls.__name__].keys() <= component.local_data.keys():
            table = _OF_SENSORS[cls.__name__]
            return lambda sensor: ((name, float(sensor.local_data[field])) for field, name in table.items())
        if cls.__name__ == "IMU":
            return _imu
        if cls.__name__ == "LaserScanner":
            return _scan
    return _general


def commands_of(component: Object) -> dict[str, str]:
    """Return the fields of an actuator by the names of their variables, without the prefix."""
    fields = component.local_data
    for cls in type(component).__mro__:
        if cls.__name__ in _OF_ACTUATORS:
            return {name: field for name, field in _OF_ACTUATORS[cls.__name__].items() if field in fields}
    return {_general_name(component, field): field for field in fields if field != "timestamp"}


def _general_name(component: Object, field: str) -> str:
    return f"{component.name()}_{field}".replace(".", "_").upper()


def _general(sensor: Sensor) -> Variables:
    """All fields as strings."""
    for field, value in sensor.local_data.items():
        yield _general_name(sensor, field), value if isinstance(value, str) else written(value)


def _imu(sensor: Sensor) -> Variables:
    for field, word in (("angular_velocity", "GYRO"), ("linear_acceleration", "ACCEL")):
        for axis, value in zip(_AXES, sensor.local_data[field], strict=True):
            yield f"IMU_{word}_{axis.upper()}", float(value)


def _scan(scanner: Any) -> Variables:
    ranges = [float(distance) for distance in scanner.local_data["range_list"]]
    yield "LIDAR_DIST", f"[1x{len(ranges)}]{{{','.join(map(repr, ranges))}}}"


def constants_of(component: Any) -> Variables:
    """The variables of a sensor that are published once."""
    if any(cls.__name__ == "LaserScanner" for cls in type(component).__mro__):
        yield "LIDAR_SCANANGLE", float(component.scan_window)
        yield "LIDAR_SCANRESOLUTION", float(component.resolution)
        yield "LIDAR_SCANRANGE", float(component.laser_range)
