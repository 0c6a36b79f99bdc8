"""Conversion of dictionaries in the format of ROS 2 to messages of rospy, and back."""

from __future__ import annotations

from functools import cache
from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from morse.core.values import RosMessage, Value


#: fields that were renamed in ROS 2, by package and message
_RENAMED = {"sensor_msgs/CameraInfo": {"d": "D", "k": "K", "r": "R", "p": "P"}}
_TIMES = ("time", "duration")


@cache
def message_class(type_name: str) -> Any:
    """The class of a type such as ``sensor_msgs/msg/Image``; None if its package is not installed."""
    package, _, name = type_name.replace("/msg/", "/").replace("/srv/", "/").partition("/")
    folder = "srv" if "/srv/" in type_name else "msg"
    try:
        return getattr(import_module(f"{package}.{folder}"), name, None)
    except ImportError:
        return None


def message(type_name: str, fields: RosMessage) -> Any:
    """A message with some fields; fields that ROS 1 does not have are ignored.

    Raises:
        ValueError, TypeError: a value does not fit its field.
    """
    instance = message_class(type_name)()
    names = _RENAMED.get(instance._type, {})
    kinds = dict(zip(instance.__slots__, instance._slot_types, strict=True))
    if instance._type == "geometry_msgs/Quaternion":
        instance.w = 1.0  # the default of ROS 1 is all zeros, which is not a rotation
    for key, value in fields.items():
        name = names.get(key, key)
        if name in kinds and value is not None:
            setattr(instance, name, _value(kinds[name], value))
    return instance


def _value(kind: str, value: Value) -> Value:
    base, bracket, _ = kind.partition("[")
    if base in _TIMES:
        import genpy

        time_class = genpy.Time if base == "time" else genpy.Duration
        return time_class(value.get("sec", 0), value.get("nanosec", 0))
    if bracket:
        if "/" in base:
            return [message(base, one) for one in value]
        return bytes(value) if base in ("uint8", "char") else value
    return message("std_msgs/Header" if base == "Header" else base, value) if "/" in base or base == "Header" else value


def plain(value: Any) -> Any:
    """A message as a dictionary with the names of ROS 2."""
    if hasattr(value, "secs"):
        return {"sec": value.secs, "nanosec": value.nsecs}
    if hasattr(value, "_slot_types"):
        back = {new: old for old, new in _RENAMED.get(value._type, {}).items()}
        return {back.get(name, name): plain(getattr(value, name)) for name in value.__slots__}
    if isinstance(value, (list, tuple)):
        return [plain(item) for item in value]
    if isinstance(value, bytes):
        import numpy as np

        return np.frombuffer(value, dtype=np.uint8)
    return value
