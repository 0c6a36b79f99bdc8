"""Products of poses, and odometry of a robot from a sensor anywhere on it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from morse.helpers.transformation import Transformation3d
from morse.mathutils.rotations import cross, quaternion_from_rotation, rotation_from_quaternion, turn
from morse.rosmsgs.parts import floats

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

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


def between(robot: Any, obj: Any) -> Transformation3d:
    """The pose of an object in the frame of another object."""
    return Transformation3d(robot).transformation3d_with(Transformation3d(obj))
