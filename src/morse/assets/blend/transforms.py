"""Poses of objects, as Blender computes them."""

from __future__ import annotations

from math import cos, sin, sqrt
from typing import TYPE_CHECKING, NamedTuple

from morse.mathutils import Euler, Matrix, Quaternion

if TYPE_CHECKING:
    from collections.abc import Sequence

    from morse.assets.blend.record import Record

_ORDERS = {1: "XYZ", 2: "XZY", 3: "YXZ", 4: "YZX", 5: "ZXY", 6: "ZYX"}
_QUATERNION, _AXIS_ANGLE = 0, -1
_ZERO, _ONE = (0.0, 0.0, 0.0), (1.0, 1.0, 1.0)
_IDENTITY = tuple(float(row == column) for row in range(4) for column in range(4))


class Pose(NamedTuple):
    """Location (m), rotation (Euler XYZ, rad) and scale in the parent's frame, delta transforms included."""

    location: list[float]
    rotation_euler: list[float]
    scale: list[float]


def pose(record: Record) -> Pose:
    """The pose of an object relative to its parent, before the parent's inverse."""
    location = [a + b for a, b in zip(record.reals("loc", _ZERO), record.reals("dloc", _ZERO), strict=True)]
    scale = record.reals(record.either("size", "scale"), _ONE)
    if record.has("dscale"):
        scale = tuple(a * b for a, b in zip(scale, record.reals("dscale", _ONE), strict=True))
    else:
        scale = tuple(a + b for a, b in zip(scale, record.reals("dsize", _ZERO), strict=True))
    return Pose(location, _rotation(record), list(scale))


def _rotation(record: Record) -> list[float]:
    mode = record.integer("rotmode", 1)
    if mode == _QUATERNION:
        delta, own = (_from_quaternion(record.reals(name, (1.0, 0.0, 0.0, 0.0))) for name in ("dquat", "quat"))
    elif mode == _AXIS_ANGLE:
        delta = _from_axis(record.reals("drotAxis", _ZERO), record.real("drotAngle", 0.0))
        own = _from_axis(record.reals("rotAxis", _ZERO), record.real("rotAngle", 0.0))
    else:
        order = _ORDERS.get(mode, "XYZ")
        angles, delta_angles = record.reals("rot", _ZERO), record.reals("drot", _ZERO)
        if order == "XYZ" and not any(delta_angles):
            # not normalised, so that scripts read the numbers of the file
            return list(angles)
        delta, own = Euler(delta_angles, order).to_matrix(), Euler(angles, order).to_matrix()
    return list((delta @ own).to_euler())


def _from_quaternion(values: Sequence[float]) -> Matrix:
    length = sqrt(sum(value * value for value in values))
    return Quaternion([value / length for value in values] if length > 1e-12 else (1.0, 0.0, 0.0, 0.0)).to_matrix()


def _from_axis(axis: Sequence[float], angle: float) -> Matrix:
    length = sqrt(sum(value * value for value in axis))
    unit = [value / length for value in axis] if length > 1e-12 else [0.0, 1.0, 0.0]
    return _from_quaternion([cos(angle / 2), *(sin(angle / 2) * value for value in unit)])


def matrix(record: Record, name: str) -> Matrix:
    """A 4x4 matrix of the file; identity where it is missing or not finite. Blender stores columns."""
    values = record.reals(name, _IDENTITY)
    return Matrix([[values[4 * column + row] for column in range(4)] for row in range(4)])


def is_identity(value: Matrix) -> bool:
    """Whether a 4x4 matrix is the identity."""
    return all(abs(value[i][j] - (i == j)) < 1e-7 for i in range(4) for j in range(4))
