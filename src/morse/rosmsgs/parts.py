"""Common parts of messages."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from morse.core.kinds import Message

_SECOND = 10**9
_NO_TURN = (0.0, 0.0, 0.0, 1.0)
#: first element of a covariance if the quantity is not measured (definition of sensor_msgs/Imu)
ABSENT = np.array([-1.0] + [0.0] * 8)


def time(stamp: int) -> dict[str, int]:
    """``builtin_interfaces/Time`` from whole ns."""
    return {"sec": stamp // _SECOND, "nanosec": stamp % _SECOND}


def header_at(stamp: int, frame: str) -> dict[str, Any]:
    """``std_msgs/Header`` from whole ns."""
    return {"stamp": time(stamp), "frame_id": frame}


def header(message: Message, frame: str) -> dict[str, Any]:
    """``std_msgs/Header``."""
    return {"stamp": time(message.stamp), "frame_id": frame}


def floats(numbers: Any) -> list[float]:
    """An array or a sequence of numbers as a list."""
    given: list[float] = numbers.tolist() if type(numbers) is np.ndarray else [float(number) for number in numbers]
    return given


def xyz(vector: Sequence[float] | None) -> dict[str, float]:
    """``Vector3`` or ``Point``; zero for None."""
    if vector is None:
        return {}
    x, y, z = floats(vector)
    return {"x": x, "y": y, "z": z}


def quaternion(wxyz: Sequence[float] | None) -> dict[str, float]:
    """A normalised ``Quaternion``; the identity for None, or for zero."""
    numbers = xyzw(wxyz)
    if numbers is _NO_TURN:
        return {}
    x, y, z, w = numbers
    return {"x": x, "y": y, "z": z, "w": w}


def xyzw(wxyz: Sequence[float] | None) -> tuple[float, float, float, float]:
    """The numbers of `quaternion`, in the order of ``Quaternion``."""
    if wxyz is None:
        return _NO_TURN
    w, x, y, z = floats(wxyz)
    length = math.sqrt(w * w + x * x + y * y + z * z)
    if not 0.0 < length < math.inf:
        return _NO_TURN
    return (x, y, z, w) if length == 1.0 else (x / length, y / length, z / length, w / length)


def three(vector: Sequence[float] | None) -> tuple[float, ...]:
    """The numbers of `xyz`."""
    return (0.0, 0.0, 0.0) if vector is None else tuple(floats(vector))


def covariance(matrix: Any) -> Any:
    """Row by row; None becomes all zeros, which means unknown."""
    return None if matrix is None else np.asarray(matrix).reshape(-1)


def from_xyz(vector: Mapping[str, float]) -> list[float]:
    """(3,) from ``Vector3`` or ``Point``."""
    return [vector["x"], vector["y"], vector["z"]]


def from_quaternion(given: Mapping[str, float]) -> list[float]:
    """(4,) w, x, y, z."""
    return [given["w"], given["x"], given["y"], given["z"]]
