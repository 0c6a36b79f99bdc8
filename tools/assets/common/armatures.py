"""Blender armatures: bones that are joints, and objects that are parented to them."""

from __future__ import annotations

from typing import NamedTuple

import bpy

from mathutils import Vector


class Joint(NamedTuple):
    """A bone and its joint.

    Attributes:
        head, tail: metres, in the armature.
        z_axis: direction of the Z axis of the bone; its Y axis points along the bone.
        axis: ``x``, ``y`` or ``z`` of the bone; empty for a bone that does not turn.
        limit: radians in both directions, or the largest angle if there is a ``low``.
        low: smallest angle, radians.
        parent: name of the bone above; None for the bone before, whose tail is then the head of this one.
    """

    name: str
    head: tuple[float, float, float]
    tail: tuple[float, float, float]
    z_axis: tuple[float, float, float]
    axis: str
    limit: float = 0.0
    low: float | None = None
    parent: str | None = None


def armature(name: str, joints: list[Joint], **properties: object) -> bpy.types.Object:
    """An armature whose bones follow each other, or branch."""
    data = bpy.data.armatures.new(name)
    data.display_type = "STICK"
    result = bpy.data.objects.new(name, data)
    bpy.context.scene.collection.objects.link(result)
    for key, value in properties.items():
        result[key] = value
    bpy.context.view_layer.objects.active = result
    bpy.ops.object.mode_set(mode="EDIT")
    above = None
    for joint in joints:
        bone = data.edit_bones.new(joint.name)
        bone.head, bone.tail = joint.head, joint.tail
        bone.align_roll(Vector(joint.z_axis))
        if joint.parent is not None:
            above = data.edit_bones[joint.parent]
        bone.parent, above = above, bone
        bone.use_connect = bone.parent is not None and joint.parent is None
    bpy.ops.object.mode_set(mode="OBJECT")
    for joint in joints:
        channel = result.pose.bones[joint.name]
        for axis in "xyz":
            setattr(channel, f"lock_ik_{axis}", axis != joint.axis)
        if not joint.axis:
            continue
        setattr(channel, f"use_ik_limit_{joint.axis}", True)
        setattr(channel, f"ik_min_{joint.axis}", -joint.limit if joint.low is None else joint.low)
        setattr(channel, f"ik_max_{joint.axis}", joint.limit)
    bpy.context.view_layer.update()
    return result


def hang(part: bpy.types.Object, holder: bpy.types.Object, bone: str) -> None:
    """Parent an object to a bone at its present pose."""
    bpy.context.view_layer.update()
    place = part.matrix_world.copy()
    part.parent, part.parent_type, part.parent_bone = holder, "BONE", bone
    bpy.context.view_layer.update()
    part.matrix_world = place
    bpy.context.view_layer.update()
