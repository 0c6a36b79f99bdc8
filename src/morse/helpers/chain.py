"""Forward kinematics: the poses of the bones of an armature."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

from morse.mathutils.rotations import Rotation9, product, turn
from morse.scene import JointKind

if TYPE_CHECKING:
    from collections.abc import Sequence

    from morse.scene import Bone

#: position (3) and rotation (9, row by row)
Pose = tuple[tuple[float, float, float], Rotation9]

_ORIGIN = (0.0, 0.0, 0.0)
_IDENTITY: Rotation9 = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)


class Chain:
    """The bones of an armature as a tree of joints.

    A joint is a bone that can move by itself. Joint values are given for all joints, in the order of `joints`: rad for
    revolute joints, m for prismatic joints. Poses are in the frame of the armature.

    Args:
        bones: the bones, parents first.
        scale: scale of the armature; lengths are multiplied by it.

    Attributes:
        bones: the bones with scaled lengths.
        joints: indices of the movable bones, ordered from the root.
        names: names of the joints.
        limits: name, lowest and highest value of each joint.
        start: the joint values of the model file.
        loose: the indices of the bones that have no value: balls, planar and floating ones.
    """

    is_apparatus = True

    def __init__(self, bones: Sequence[Bone], scale: float = 1.0) -> None:
        self.bones = tuple(_scaled(bone, scale) for bone in bones)
        moving = [(i, bone) for i, bone in enumerate(self.bones) if bone.kind.has_value]
        self.joints = tuple(i for i, bone in moving if bone.leader < 0)
        self.names = tuple(self.bones[i].name for i in self.joints)
        self.limits = [(self.bones[i].name, self.bones[i].low, self.bones[i].high) for i in self.joints]
        self.start = [self.bones[i].value for i in self.joints]
        self.loose = tuple(i for i, bone in enumerate(self.bones) if bone.kind.is_loose)
        self._number = {bone: number for number, bone in enumerate(self.joints)}
        #: for joints that follow others: the index of the leader
        self._led = {i: self._number[bone.leader] for i, bone in moving if bone.leader in self._number}
        #: the bones for a linkage; bones without a leader are fixed
        self.linked = tuple(
            bone
            if bone.kind is JointKind.FIXED or i in self._number or i in self._led
            else replace(bone, kind=JointKind.FIXED)
            for i, bone in enumerate(self.bones)
        )
        self._moving = [
            (self._number.get(i), i) for i, bone in enumerate(self.linked) if bone.kind is not JointKind.FIXED
        ]
        self._index = {bone.name: i for i, bone in enumerate(self.bones)}

    def index(self, bone: str) -> int | None:
        """The index of the bone of that name, or None."""
        return self._index.get(bone)

    def joint(self, number: int) -> Bone:
        """The bone that a joint moves."""
        return self.bones[self.joints[number]]

    def clamped(self, number: int, value: float) -> float:
        """Clip a value of a joint to its limits."""
        bone = self.bones[self.joints[number]]
        return min(max(value, bone.low), bone.high)

    def bone_values(self, values: Sequence[float]) -> Sequence[float]:
        """The values of all movable bones, computed from those of the joints."""
        if not self._led:
            return values
        return [
            values[number] if number is not None else self.bones[i].factor * values[self._led[i]] + self.bones[i].offset
            for number, i in self._moving
        ]

    def frames(self, values: Sequence[float]) -> list[Pose]:
        """The frame of every bone: its origin at the joint, its Y axis along the bone."""
        poses: list[Pose] = []
        for i, bone in enumerate(self.bones):
            p, r = poses[bone.parent] if bone.parent >= 0 else (_ORIGIN, _IDENTITY)
            x, y, z = turn(r, bone.position)
            position, rotation = (p[0] + x, p[1] + y, p[2] + z), product(r, bone.rotation)
            number = self._number.get(i)
            if number is not None or i in self._led:
                value = values[number] if number is not None else bone.factor * values[self._led[i]] + bone.offset
                if bone.kind is JointKind.PRISMATIC:
                    a = bone.axis
                    position = (
                        position[0] + value * rotation[a],
                        position[1] + value * rotation[a + 3],
                        position[2] + value * rotation[a + 6],
                    )
                else:
                    rotation = _turned(rotation, bone.axis, value)
            poses.append((position, rotation))
        return poses

    def tip(self, frame: Pose, index: int) -> Pose:
        """The pose of the tip of a bone with a given frame."""
        (x, y, z), r = frame
        length = self.bones[index].length
        return (x + length * r[1], y + length * r[4], z + length * r[7]), r

    def path(self, index: int) -> list[int]:
        """The indices of the joints that move a bone, ordered from the root."""
        bones = []
        while index >= 0:
            if index in self._number:
                bones.append(self._number[index])
            index = self.bones[index].parent
        return bones[::-1]


def _scaled(bone: Bone, scale: float) -> Bone:
    if scale == 1.0:
        return bone
    x, y, z = bone.position
    new_bone = replace(bone, position=(scale * x, scale * y, scale * z), length=scale * bone.length)
    if bone.kind is JointKind.PRISMATIC:
        new_bone = replace(new_bone, low=scale * bone.low, high=scale * bone.high, value=scale * bone.value)
    return new_bone


def _turned(r: Sequence[float], axis: int, angle: float) -> Rotation9:
    """A rotation followed by a rotation about one of its own axes: a combination of its other two columns."""
    c, s = math.cos(angle), math.sin(angle)
    one, other = (axis + 1) % 3, (axis + 2) % 3
    result = list(r)
    for row in (0, 3, 6):
        result[row + one] = c * r[row + one] + s * r[row + other]
        result[row + other] = c * r[row + other] - s * r[row + one]
    a, b, c, d, e, f, g, h, i = result
    return a, b, c, d, e, f, g, h, i
