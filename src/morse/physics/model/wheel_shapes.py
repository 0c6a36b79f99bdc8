"""The geometry of wheels."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from morse.mathutils.portable import matmul, norm
from morse.physics.model.inertia import bounding_box
from morse.physics.poses.poses import as_array
from morse.scene.frames import rigid_frame

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from morse.scene import Node


def _rotation(node: Node) -> NDArray[np.float64]:
    return as_array(rigid_frame(node).rotation)


def wheel_axis(wheel: Node, robot: Node) -> NDArray[np.float64]:
    """Return the axle (3,) in the frame of the wheel: the Y axis of the robot, so that positive speed is forward."""
    return np.asarray(matmul(_rotation(wheel).T, _rotation(robot)[:, 1]))


def wheel_size(wheel: Node, axis: NDArray[np.float64]) -> tuple[float, float, NDArray[np.float64]]:
    """Return radius and half width of the shapes of a wheel, m, and the rotation (3, 3) from Z to the axle."""
    z = axis / norm(axis)
    helper = np.array([1.0, 0.0, 0.0]) if abs(z[0]) < 0.9 else np.array([0.0, 1.0, 0.0])
    x = np.cross(helper, z)
    x /= norm(x)
    rotation = np.column_stack([x, np.cross(z, x), z])
    lower, upper = np.full(3, np.inf), np.full(3, -np.inf)
    for shape in wheel.shapes or ():
        low, high = bounding_box(shape, np.zeros(3), rotation.T)
        lower, upper = np.minimum(lower, low), np.maximum(upper, high)
    half = (upper - lower) / 2
    return float(max(half[0], half[1])), float(half[2]), rotation
