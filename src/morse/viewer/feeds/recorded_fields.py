"""Fields of sensors from the recorded messages of ROS."""

from __future__ import annotations

import json
import math
from typing import TYPE_CHECKING, Any

import numpy as np

from morse.core.exceptions import MorseError
from morse.core.kinds import bind
from morse.mathutils.rotations import cross, turn_back
from morse.rosmsgs.poses import inverse, pose_of, product, quaternion_of

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

_PLACE = ("latitude", "longitude", "altitude")
#: maximum number of levels of a message that are written as one name
_DEEPEST = 6


def fields_of(message: dict[str, Any], type_name: str, component: Any, topic: str = "") -> dict[str, Any]:
    """The fields of a component in a message; else the values of the message by their names in ROS, without its header.

    Args:
        message: decoded.
        type_name: its type.
        component: the sensor that sent it.
        topic: last part of the name of the topic; the name of the field, if a message consists of one field.
    """
    if type_name == "sensor_msgs/msg/LaserScan":
        ranges = np.asarray(message["ranges"], dtype=np.float64)
        return {"range_list": np.where(np.isfinite(ranges), ranges, message["range_max"])}
    kind_name, slots_of = _SLOTS.get(type_name, ("", _nothing))
    if kind_name:
        kind = next((kind for kind in bind(component) if kind.kind.name == kind_name), None)
        slots = slots_of(message, component)
        fields = {} if kind is None else kind.scatter(slots)[0]
        if kind_name == "odometry" and fields:
            fields |= _euler_rates(fields, slots["angular"])
        if fields:
            return fields
    if type_name == "std_msgs/msg/String":
        return _from_text(message["data"])
    if set(message) == {"data"} and topic in component.local_data:
        return {topic: message["data"]}
    return dict(_flat({name: value for name, value in message.items() if name != "header"}))


def _flat(value: Any, name: str = "") -> list[tuple[str, Any]]:
    if not isinstance(value, dict) or name.count(".") >= _DEEPEST:
        return [(name, value)]
    return [pair for part, inner in value.items() for pair in _flat(inner, f"{name}.{part}" if name else part)]


def _from_text(text: str) -> dict[str, Any]:
    try:
        found = json.loads(text)
    except (ValueError, RecursionError):
        found = None
    return found if isinstance(found, dict) else {"data": text}


def _xyz(vector: Mapping[str, float]) -> list[float]:
    return [vector[axis] for axis in "xyz"]


def _wxyz(turn: Mapping[str, float]) -> list[float]:
    return [turn[axis] for axis in "wxyz"]


def _nothing(message: Mapping[str, Any], component: Any) -> dict[str, Any]:
    return {}


def _pose(message: Mapping[str, Any], component: Any) -> dict[str, Any]:
    pose = message["pose"].get("pose", message["pose"])
    return {"position": _xyz(pose["position"]), "orientation": _wxyz(pose["orientation"])}


def _odometry(message: Mapping[str, Any], component: Any) -> dict[str, Any]:
    """The message is about the robot, wherever the sensor is mounted."""
    pose, twist = message["pose"]["pose"], message["twist"]["twist"]
    mounting = component.sensor_to_robot_position_3d()
    robot = pose_of(_xyz(pose["position"]), _wxyz(pose["orientation"]))
    sensor = product(inverse(mounting), product(robot, mounting))
    offset, rotation = mounting.get_pose()
    angular = _xyz(twist["angular"])
    moving = [v + w for v, w in zip(_xyz(twist["linear"]), cross(angular, offset), strict=True)]
    return {
        "position": [sensor.x, sensor.y, sensor.z],
        "orientation": quaternion_of(sensor),
        "linear": turn_back(rotation, moving),
        "angular": turn_back(rotation, angular),
    }


def _euler_rates(fields: Mapping[str, float], angular: Sequence[float]) -> dict[str, float]:
    """The rates of the Euler angles, rad/s, from the angular velocity in body axes (Diebel 2006, equation 76)."""
    p, q, r = angular
    sin_roll, cos_roll, cos_pitch = math.sin(fields["roll"]), math.cos(fields["roll"]), math.cos(fields["pitch"])
    if cos_pitch == 0.0:
        return {}
    yaw_rate = (sin_roll * q + cos_roll * r) / cos_pitch
    return {
        "wx": p + math.sin(fields["pitch"]) * yaw_rate,
        "wy": cos_roll * q - sin_roll * r,
        "wz": yaw_rate,
    }


def _twist(message: Mapping[str, Any], component: Any) -> dict[str, Any]:
    twist = message["twist"].get("twist", message["twist"])
    return {"linear": _xyz(twist["linear"]), "angular": _xyz(twist["angular"])}


def _imu(message: Mapping[str, Any], component: Any) -> dict[str, Any]:
    quantities = {name: _xyz(message[name]) for name in ("angular_velocity", "linear_acceleration")}
    # the first element of the covariance is -1 if the quantity is not measured
    measured = {name: value for name, value in quantities.items() if message[f"{name}_covariance"][0] >= 0.0}
    turned = message["orientation_covariance"][0] >= 0.0
    return {**measured, "orientation": _wxyz(message["orientation"])} if turned else measured


def _joints(message: Mapping[str, Any], component: Any) -> dict[str, Any]:
    return {name: message[name] for name in ("position", "velocity", "effort") if len(message[name])}


def _alone(slot: str, name: str) -> Callable[[Mapping[str, Any], Any], dict[str, Any]]:
    """A message with one value."""
    return lambda message, component: {slot: message[name]}


#: kind of the sensor, and slots of the message, by the type of the message
_SLOTS: dict[str, tuple[str, Callable[[Mapping[str, Any], Any], dict[str, Any]]]] = {
    "geometry_msgs/msg/PoseStamped": ("pose", _pose),
    "geometry_msgs/msg/PoseWithCovarianceStamped": ("pose", _pose),
    "geometry_msgs/msg/PointStamped": ("pose", lambda message, _: {"position": _xyz(message["point"])}),
    "nav_msgs/msg/Odometry": ("odometry", _odometry),
    "geometry_msgs/msg/TwistStamped": ("twist", _twist),
    "geometry_msgs/msg/TwistWithCovarianceStamped": ("twist", _twist),
    "sensor_msgs/msg/Imu": ("imu", _imu),
    "sensor_msgs/msg/MagneticField": ("magnetic_field", lambda message, _: {"field": _xyz(message["magnetic_field"])}),
    "sensor_msgs/msg/NavSatFix": ("fix", lambda message, _: {name: message[name] for name in _PLACE}),
    "sensor_msgs/msg/Range": ("range", _alone("distance", "range")),
    "sensor_msgs/msg/Temperature": ("temperature", _alone("temperature", "temperature")),
    "sensor_msgs/msg/FluidPressure": ("pressure", _alone("absolute", "fluid_pressure")),
    "sensor_msgs/msg/BatteryState": ("battery", _alone("charge", "percentage")),
    "sensor_msgs/msg/JointState": ("joints", _joints),
    "std_msgs/msg/Bool": ("contact", _alone("touching", "data")),
}

#: errors of damaged messages
DAMAGED = (MorseError, ValueError, LookupError, TypeError, ArithmeticError)
