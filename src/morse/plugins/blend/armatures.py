"""Armatures as trees of joints: which axis a bone may turn about or slide along, and how far.

Joints come from the inverse kinematics settings of a bone (Bone > Inverse Kinematics): unlocked axes, limits, and
stretch for a bone that slides along its own axis.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

from morse.mathutils import Euler, Matrix, Quaternion, Vector
from morse.mathutils.rotations import nine
from morse.plugins.blend.poses import matrix
from morse.scene import Bone, JointKind

if TYPE_CHECKING:
    from collections.abc import Iterator

    from morse.plugins.blend.file import Record

_LOCKED = (1 << 0, 1 << 1, 1 << 2)
_LIMITED = (1 << 3, 1 << 4, 1 << 5)
_CONNECTED = 1 << 4
_MAX_BONES = 4096
_AXIS_ANGLE = -1
_ORDERS = ("", "XYZ", "XZY", "YXZ", "YZX", "ZXY", "ZYX")
_SHORTEST = 1e-9
_ORIGIN = (0.0, 0.0, 0.0)
_UNIT_QUATERNION = (1.0, 0.0, 0.0, 0.0)


class _Joint(NamedTuple):
    kind: JointKind = JointKind.FIXED
    axis: int = 1
    free: tuple[bool, bool, bool] = (False, False, False)
    low: float = 0.0
    high: float = 0.0
    value: float = 0.0


def bones(record: Record) -> tuple[Bone, ...]:
    """Return the bones of an armature object, parents before their children.

    Bones beyond the first 4096 are left out, with a warning.
    """
    armature = record.follow("data", "bArmature")
    if armature is None:
        return ()
    pose = record.follow("pose", "bPose") if record.has("pose") else None
    channels = {} if pose is None else {c.text("name"): c for c in pose.chain("chanbase", "bPoseChannel")}
    bone_list: list[Bone] = []
    frames: list[Matrix] = []
    for bone, parent in _walk(armature):
        if len(bone_list) >= _MAX_BONES:
            record.file.warn(f"an armature has more than {_MAX_BONES} bones; the others are left out")
            break
        name = bone.text("name")
        frame = _rest(bone)
        local = frame if parent < 0 else frames[parent].inverted() @ frame
        channel = channels.get(name)
        joint = _Joint() if channel is None else _joint(channel)
        if channel is not None:
            local = local @ _fixed_part(bone, channel, joint)
        length = math.dist(bone.reals("arm_head", _ORIGIN), bone.reals("arm_tail", _ORIGIN))
        x, y, z = local.translation
        rotation = nine(list(local.to_3x3()))
        bone_list.append(Bone(name, parent, (x, y, z), rotation, length, *joint))
        frames.append(frame)
    return tuple(bone_list)


def _walk(armature: Record) -> Iterator[tuple[Record, int]]:
    """Iterate over all bones with the index of the parent bone; parents first, in the order of the file."""
    queue = [(bone, -1) for bone in reversed(list(armature.chain("bonebase", "Bone")))]
    bones_so_far: set[int] = set()
    while queue:
        bone, parent = queue.pop()
        if bone.block.offset in bones_so_far:
            continue
        index = len(bones_so_far)
        bones_so_far.add(bone.block.offset)
        yield bone, parent
        queue.extend((child, index) for child in reversed(list(bone.chain("childbase", "Bone"))))


def _rest(bone: Record) -> Matrix:
    """The rest pose of a bone in the frame of the armature, without scale."""
    frame = matrix(bone, "arm_mat")
    rotation = frame.to_3x3() if abs(frame.determinant()) > _SHORTEST else Matrix.Identity(3)
    result = rotation.to_quaternion().normalized().to_matrix().to_4x4()
    result.translation = bone.reals("arm_head", _ORIGIN)
    return result


def _joint(channel: Record) -> _Joint:
    """The joint that the channel of a bone describes."""
    flags = channel.integer("ikflag", 0)
    stretch = channel.real("ikstretch")
    if stretch > 0.0:
        value = min(max(channel.reals("loc", _ORIGIN)[1], 0.0), stretch)
        return _Joint(JointKind.PRISMATIC, low=0.0, high=stretch, value=value)
    x, y, z = (not flags & mask for mask in _LOCKED)
    if not (x or y or z):
        return _Joint()
    axis = (x, y, z).index(True)
    low, high = -math.pi, math.pi
    if flags & _LIMITED[axis]:
        one, other = channel.reals("limitmin", (low,) * 3)[axis], channel.reals("limitmax", (high,) * 3)[axis]
        low, high = min(one, other), max(one, other)
    pose = _posed(channel)
    angle = math.remainder(2.0 * math.atan2(pose[axis + 1], pose[0]), math.tau)
    return _Joint(JointKind.REVOLUTE, axis, (x, y, z), low, high, min(max(angle, low), high))


def _posed(channel: Record) -> Quaternion:
    """The rotation of a bone from its rest pose, as it was saved."""
    mode = channel.integer("rotmode", 0)
    if 0 < mode < len(_ORDERS):
        return Euler(channel.reals("eul", _ORIGIN), _ORDERS[mode]).to_quaternion()
    if mode == _AXIS_ANGLE:
        axis, angle = channel.reals("rotAxis", (0.0, 1.0, 0.0)), channel.real("rotAngle")
        length = math.hypot(*axis)
        if length <= _SHORTEST:
            return Quaternion(_UNIT_QUATERNION)
        half = math.sin(0.5 * angle) / length
        return Quaternion((math.cos(0.5 * angle), *(half * value for value in axis)))
    quaternion = Quaternion(channel.reals("quat", _UNIT_QUATERNION))
    return quaternion.normalized() if quaternion.magnitude > _SHORTEST else Quaternion(_UNIT_QUATERNION)


def _fixed_part(bone: Record, channel: Record, joint: _Joint) -> Matrix:
    """Return the part of the saved pose relative to the rest pose that is not the value of the joint."""
    pose = _posed(channel)
    if joint.kind is JointKind.REVOLUTE:
        axis = Vector([float(i == joint.axis) for i in range(3)])
        pose = pose @ Quaternion((math.cos(0.5 * joint.value), *(-math.sin(0.5 * joint.value) * axis)))
    result = pose.to_matrix().to_4x4()
    if not bone.integer("flag", 0) & _CONNECTED:
        offset = list(channel.reals("loc", _ORIGIN))
        if joint.kind is JointKind.PRISMATIC:
            offset[1] -= joint.value
        result.translation = offset
    return result
