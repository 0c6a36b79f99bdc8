"""The frames of parents: an object, one of its vertices, or one of its bones."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.assets.blend.mesh_arrays import vertex
from morse.assets.blend.transforms import matrix
from morse.mathutils import Matrix

if TYPE_CHECKING:
    from morse.assets.blend.record import Record

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
