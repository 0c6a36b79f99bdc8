"""Common parts of messages.

Numbers may be those of many messages at once: columns (R,) instead of numbers, rows (R, N) instead of vectors.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

    from morse.core.kinds import Message
    from morse.core.values import RosMessage

_SECOND = 10**9
_NO_TURN = (0.0, 0.0, 0.0, 1.0)
#: first element of a covariance if the quantity is not measured (definition of sensor_msgs/Imu)
ABSENT = np.array([-1.0] + [0.0] * 8)


def time(stamp: Any) -> dict[str, int]:
    """``builtin_interfaces/Time`` from whole ns."""
    return {"sec": stamp // _SECOND, "nanosec": stamp % _SECOND}


def header_at(stamp: object, frame: str) -> RosMessage:
    """``std_msgs/Header`` from whole ns."""
    return {"stamp": time(stamp), "frame_id": frame}


def header(message: Message, frame: str) -> RosMessage:
    """``std_msgs/Header``."""
    return {"stamp": time(message.stamp), "frame_id": frame}


def floats(numbers: Any) -> list[float]:
    """An array or a sequence of numbers as a list; of rows (R, N) of numbers, the list of N columns (R,)."""
    if type(numbers) is not np.ndarray:
        return [float(number) for number in numbers]
    parts: list[float] = numbers.tolist() if numbers.ndim < 2 else list(np.moveaxis(numbers, -1, 0))
    return parts


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
    if isinstance(w, np.ndarray):
        return _unit_rows(x, y, z, w)
    length = math.sqrt(w * w + x * x + y * y + z * z)
    if not 0.0 < length < math.inf:
        return _NO_TURN
    return (x, y, z, w) if length == 1.0 else (x / length, y / length, z / length, w / length)


def _unit_rows(*parts: NDArray[np.float64]) -> tuple[object, object, object, object]:
    """The quaternions x, y, z, w of many rows, with the bits of `xyzw`."""
    x, y, z, w = parts
    with np.errstate(all="ignore"):
        length = np.sqrt(w * w + x * x + y * y + z * z)
        is_turn = (length > 0.0) & (length < math.inf)
        return tuple(  # type: ignore[return-value]
            np.where(is_turn, part / length, identity) for part, identity in zip(parts, _NO_TURN, strict=True)
        )


def three(vector: Sequence[float] | None) -> tuple[float, ...]:
    """The numbers of `xyz`."""
    return (0.0, 0.0, 0.0) if vector is None else tuple(floats(vector))


def covariance(matrix: object) -> Any:
    """Row by row; None becomes all zeros, which means unknown."""
    if matrix is None:
        return None
    numbers = np.asarray(matrix)
    return numbers.reshape(-1) if numbers.ndim < 3 else numbers.reshape(len(numbers), -1)


def from_xyz(vector: Mapping[str, float]) -> list[float]:
    """(3,) from ``Vector3`` or ``Point``."""
    return [vector["x"], vector["y"], vector["z"]]


def from_quaternion(value: Mapping[str, float]) -> list[float]:
    """(4,) w, x, y, z."""
    return [value["w"], value["x"], value["y"], value["z"]]
