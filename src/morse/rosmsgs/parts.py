"""Common parts of messages, products of poses, and data as standard JSON.

Numbers may be those of many messages at once: columns (R,) instead of numbers, rows (R, N) instead of vectors.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, NamedTuple

import msgspec
import numpy as np

from morse.core.streams.extent import listed
from morse.helpers.transformation import Transformation3d
from morse.mathutils.rotations import cross, quaternion_from_rotation, rotation_from_quaternion, turn

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

    from morse.core.kinds import Message
    from morse.core.values import RosMessage
    from morse.core.world import Body


def _plain(value: object) -> object:
    if hasattr(value, "tolist"):  # numpy
        return listed(value)
    if isinstance(value, (set, frozenset)):
        return sorted(value, key=str)  # the order of a set differs between processes
    if hasattr(value, "__iter__"):  # vectors and matrices
        return list(value)
    return str(value)


_ENCODER = msgspec.json.Encoder(enc_hook=_plain)


def as_json(value: object) -> str:
    """A value as JSON.

    Raises:
        ValueError, TypeError, RecursionError: it has no JSON representation.
    """
    return _ENCODER.encode(value).decode()


def from_json(text: str) -> object:
    """Parse JSON of a client.

    Raises:
        ValueError: the text is not JSON.
    """
    try:
        return msgspec.json.decode(text)
    except (msgspec.DecodeError, RecursionError) as error:
        raise ValueError(f"not JSON ({error})") from None


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


NO_DISPLACEMENT = Transformation3d()


class Motion(NamedTuple):
    """Pose relative to the start, and velocity of a robot.

    Attributes:
        pose: of the robot relative to its initial pose.
        linear: (3,) m/s in the axes of the robot.
        angular: (3,) rad/s in the axes of the robot.
    """

    pose: Transformation3d
    linear: Sequence[float]
    angular: Sequence[float]


def covariance_of_robot(matrix: Any, mounting: Transformation3d, arm: Sequence[float]) -> NDArray[np.float64] | None:
    """The covariance of the robot, from that of a sensor on it: the adjoint of its pose on the robot.

    Args:
        matrix: (6, 6) of translations and rotations along the axes of the sensor; None if it is unknown.
        mounting: pose of the sensor on the robot.
        arm: (3,) place of the sensor on the robot, m, in the axes of the result.
    """
    if matrix is None:
        return None
    rotation = np.reshape(mounting.get_pose()[1], (3, 3))
    x, y, z = arm
    change = np.zeros((6, 6))
    change[:3, :3] = change[3:, 3:] = rotation
    lever = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    change[:3, 3:] = np.einsum("ij,jk->ik", lever, rotation)
    result: NDArray[np.float64] = np.einsum("ij,jk,lk->il", change, matrix, change)
    return result


def pose_of(position: Sequence[float], quaternion: Sequence[float]) -> Transformation3d:
    """A pose from a position and a unit quaternion w, x, y, z."""
    pose = Transformation3d()
    w, x, y, z = floats(quaternion)
    px, py, pz = floats(position)
    pose.set_pose((px, py, pz), rotation_from_quaternion(w, x, y, z))
    return pose


def inverse(pose: Transformation3d) -> Transformation3d:
    """The inverse of a pose."""
    return pose.transformation3d_with(NO_DISPLACEMENT)


def product(first: Transformation3d, second: Transformation3d) -> Transformation3d:
    """The product of two poses: the second one is given in the frame of the first one."""
    return inverse(first).transformation3d_with(second)


def quaternion_of(pose: Transformation3d) -> tuple[float, ...]:
    """The rotation of a pose as a quaternion w, x, y, z."""
    return quaternion_from_rotation(tuple(pose.get_pose()[1]))  # type: ignore[arg-type]


def motion_of_robot(sensor: Transformation3d, linear: object, angular: object, mounting: Transformation3d) -> Motion:
    """The motion of the robot, from the motion of a sensor on it.

    Args:
        sensor: pose of the sensor relative to its own initial pose.
        linear: (3,) m/s in the axes of the sensor.
        angular: (3,) rad/s in the axes of the sensor.
        mounting: pose of the sensor on the robot.
    """
    pose = product(mounting, product(sensor, inverse(mounting)))
    offset, rotation = mounting.get_pose()
    turning = turn(rotation, floats(angular))
    # velocities of two points of a rigid body differ by the cross product of the angular velocity and their offset
    moving = [v - w for v, w in zip(turn(rotation, floats(linear)), cross(turning, offset), strict=True)]
    return Motion(pose, moving, turning)


#: rotation from axes with X forward, Z up, to axes with Z forward, Y down, w, x, y, z
OPTICAL_TURN = (0.5, -0.5, 0.5, -0.5)
OPTICAL_INVERSE = inverse(pose_of((0.0, 0.0, 0.0), OPTICAL_TURN))


def between(robot: Body, obj: Body) -> Transformation3d:
    """The pose of an object in the frame of another object."""
    return Transformation3d(robot).transformation3d_with(Transformation3d(obj))
