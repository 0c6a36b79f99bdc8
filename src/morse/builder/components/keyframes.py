"""Initial poses of robots that their files name."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from morse.builder.errors import checks
from morse.core.exceptions import MorseBuilderError
from morse.mathutils import Matrix, Quaternion
from morse.scene.bone_frames import start_frames

if TYPE_CHECKING:
    from morse.scene import Library, Node
    from morse.scene.bone_frames import BonePose


def set_keyframe(root: Node, library: Library, name: str) -> None:
    """Give a robot the joint values and the place of a keyframe of its file.

    Raises:
        MorseBuilderError: the file has no such keyframe.
    """
    keyframe = library.keyframes.get(name)
    if keyframe is None:
        names = ", ".join(f"'{one}'" for one in library.keyframes) or "none"
        raise MorseBuilderError(
            f"{library.path} has no keyframe '{name}'{checks.suggestion(name, library.keyframes)}; it has: {names}"
        )
    if keyframe.place is not None:
        position, quaternion = keyframe.place
        root.location = list(position)
        root.rotation_euler = list(Quaternion(quaternion).to_euler())
    for armature in [node for node in root.walk() if node.bones]:
        before = [_matrix(frame) for frame in start_frames(armature.bones)]
        armature.bones = tuple(
            replace(bone, value=keyframe.joints[bone.name][0])
            if bone.kind.has_value and bone.name in keyframe.joints
            else bone
            for bone in armature.bones
        )
        after = [_matrix(frame) for frame in start_frames(armature.bones)]
        index = {bone.name: number for number, bone in enumerate(armature.bones)}
        for child in armature.children:
            if child.bone in index:
                number = index[child.bone]
                place = after[number] @ before[number].inverted() @ child.basis_matrix()
                child.location, child.rotation_euler = list(place.translation), list(place.to_euler())


def _matrix(frame: BonePose) -> Matrix:
    (x, y, z), r = frame
    matrix = Matrix((r[:3], r[3:6], r[6:])).to_4x4()
    matrix.translation = (x, y, z)
    return matrix
