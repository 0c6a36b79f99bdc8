"""The initial poses of the bones of an armature."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from morse.mathutils.rotations import Rotation9, product, turn
from morse.scene.armature import JointKind

if TYPE_CHECKING:
    from collections.abc import Sequence

    from morse.scene.armature import Bone

#: position (3) and rotation (9, row by row)
BonePose = tuple[tuple[float, float, float], Rotation9]

_IDENTITY: Rotation9 = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)


def start_value(bones: Sequence[Bone], index: int) -> float:
    """Return the initial value of a joint, rad or m; for a joint that follows another, it is usually computed."""
    bone = bones[index]
    return bone.value if bone.leader < 0 or bone.starts_apart else bone.factor * bones[bone.leader].value + bone.offset


def start_frames(bones: Sequence[Bone], scale: float = 1.0) -> list[BonePose]:
    """Return the initial frame of each bone in the frame of the armature; its origin is at the joint.

    Args:
        scale: scale of the armature; lengths are multiplied by it.
    """
    poses: list[BonePose] = []
    for index, bone in enumerate(bones):
        p, r = poses[bone.parent] if bone.parent >= 0 else ((0.0, 0.0, 0.0), _IDENTITY)
        x, y, z = turn(r, bone.position)
        position, rotation = (p[0] + scale * x, p[1] + scale * y, p[2] + scale * z), product(r, bone.rotation)
        value = start_value(bones, index)
        a = bone.axis
        if bone.kind is JointKind.PRISMATIC:
            value *= scale
            x, y, z = rotation[a], rotation[a + 3], rotation[a + 6]
            position = (position[0] + value * x, position[1] + value * y, position[2] + value * z)
        elif bone.kind is JointKind.REVOLUTE and value:
            rotation = product(rotation, _about(a, value))
        poses.append((position, rotation))
    return poses


def _about(axis: int, angle: float) -> Rotation9:
    """The rotation about the X, Y or Z axis."""
    c, s = math.cos(angle), math.sin(angle)
    if axis == 0:
        return 1.0, 0.0, 0.0, 0.0, c, -s, 0.0, s, c
    if axis == 1:
        return c, 0.0, s, 0.0, 1.0, 0.0, -s, 0.0, c
    return c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0
