"""Poses of objects, and their parents."""

from __future__ import annotations

from math import cos, sin, sqrt
from typing import TYPE_CHECKING, NamedTuple

from morse.mathutils import Euler, Matrix, Quaternion
from morse.plugins.blend.meshes import vertex

if TYPE_CHECKING:
    from collections.abc import Sequence

    from morse.plugins.blend.file import Record

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


_KIND = 15
VERTEX, TRIANGLE, BONE = 5, 6, 7
_RELATIVE = 1 << 23
_MAX_BONES = 100_000


def parent_kind(record: Record) -> int:
    """Return the kind of parent: `VERTEX`, `TRIANGLE`, `BONE`, or another number for the object itself."""
    return record.integer("partype", 0) & _KIND


def parent_frame(record: Record, parent: Record) -> Matrix | None:
    """Return the 4x4 pose of the part to which an object is parented, in the frame of the parent object, or None."""
    kind = parent_kind(record)
    if kind == BONE:
        return _bone_frame(parent, record.text("parsubstr"))
    if kind in (VERTEX, TRIANGLE):
        return _vertex_frame(parent, [record.integer(f"par{i}", 0) for i in range(1, 4 if kind == TRIANGLE else 2)])
    return None


def _bone_frame(parent: Record, name: str) -> Matrix | None:
    """The tail of a bone in its present pose; in its rest pose if the file has no other."""
    bone = _bone(parent, name)
    relative = bone is not None and bone.integer("flag", 0) & _RELATIVE
    pose = parent.follow("pose", "bPose") if parent.has("pose") else None
    for channel in pose.chain("chanbase", "bPoseChannel") if pose is not None else ():
        if channel.text("name") == name:
            frame = matrix(channel, "chan_mat" if relative else "pose_mat")
            if abs(frame.determinant()) > 1e-12:
                return frame if relative else _moved_to(frame, channel.reals("pose_tail", (0.0, 0.0, 0.0)))
    if bone is None or relative:
        return None
    return _moved_to(matrix(bone, "arm_mat"), bone.reals("arm_tail", (0.0, 0.0, 0.0)))


def _moved_to(frame: Matrix, position: tuple[float, ...]) -> Matrix:
    frame.translation = position
    return frame


def _bone(parent: Record, name: str) -> Record | None:
    armature = parent.follow("data", "bArmature")
    queue = [] if armature is None else list(armature.chain("bonebase", "Bone"))
    for _ in range(_MAX_BONES):
        if not queue:
            break
        bone = queue.pop()
        if bone.text("name") == name:
            return bone
        queue.extend(bone.chain("childbase", "Bone"))
    return None


def _vertex_frame(parent: Record, indices: list[int]) -> Matrix | None:
    """A vertex, or the mean of three vertices."""
    mesh = parent.follow("data", "Mesh") if parent.integer("type") == 1 else None
    if mesh is None:
        return None
    points = [point for index in indices if (point := vertex(mesh, index)) is not None]
    if len(points) < len(indices):
        return None
    return Matrix.Translation([sum(axis) / len(points) for axis in zip(*points, strict=True)])
