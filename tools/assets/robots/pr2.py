"""A PR2: a base on casters, a torso that rises, a head that pans and tilts, and two arms of seven joints.

The joints have the names, places and limits of the robot's own description; at zero, both arms point ahead.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from common.armatures import Joint, armature, hang
from common.colors import NAVY, RUBBER, STEEL, WHITE
from common.materials import material
from common.objects import empty, hidden_box, solid
from common.shapes import box, cylinder, ellipsoid, lathe, rounded_box, sphere

if TYPE_CHECKING:
    import bpy
    from common.objects import Triple
    from common.parts import Part

_UP, _DOWN = (0.0, 0.0, 1.0), (0.0, 0.0, -1.0)
#: the foot of the torso's slide, the axis of the neck, and the left shoulder at the lowest position of the torso
_TORSO, _NECK, _SHOULDER = (-0.05, 0.0, 0.791), (-0.067, 0.0, 1.172), (-0.05, 0.188, 0.791)
_LIFT = 0.31


def _arm(side: str) -> list[Joint]:
    """The joints of an arm along X: those with Z up and the axis X turn up, those with Z down turn down."""
    sign = 1 if side == "l" else -1
    x, y, z = _SHOULDER
    pan = (-0.715, 2.285) if side == "l" else (-2.285, 0.715)
    roll = (-2.329, 2.371) if side == "l" else (-2.371, 2.329)
    found, start = [], 0.0
    for name, length, above, axis, low, high in (
        ("shoulder_pan", 0.1, _UP, "z", *pan),
        ("shoulder_lift", 0.123, _DOWN, "x", -0.524, 1.396),
        ("upper_arm_roll", 0.277, _UP, "y", *roll),
        ("elbow_flex", 0.094, _UP, "x", 0.0, 2.321),
        ("forearm_roll", 0.227, _UP, "y", -math.pi, math.pi),
        ("wrist_flex", 0.042, _UP, "x", 0.0, 2.18),
        ("wrist_roll", 0.083, _UP, "y", -math.pi, math.pi),
    ):
        head, tail = ((x + reach, sign * y, z) for reach in (start, start + length))
        found.append(Joint(f"{side}_{name}_joint", head, tail, above, axis, high, low))
        start += length
    return found


def build() -> None:
    white, black, steel = (
        material("Shell", WHITE, 0.35),
        material("Cover", NAVY, 0.4),
        material("Steel", STEEL, 0.3, 0.9),
    )
    grey, rubber, glass = (
        material("Grey", "#8d939b", 0.5),
        material("Tyre", RUBBER, 0.8),
        material("Glass", "#101820", 0.1),
    )
    robot = empty("pr2", physics_type="RIGID_BODY", compound=1, mass=140.0)
    hidden_box("base_Collision", (0.668, 0.668, 0.35), (0, 0, 0.175), parent=robot, physics_type="RIGID_BODY", mass=1.0)
    hidden_box("rear_Collision", (0.25, 0.5, 0.75), (-0.19, 0, 0.7), parent=robot, physics_type="RIGID_BODY", mass=1.0)
    base = [
        rounded_box(0.668, 0.668, 0.2, 0.07, 4).moved(0, 0, 0.2).painted(white),
        rounded_box(0.64, 0.64, 0.03, 0.012, 2).moved(0, 0, 0.09).painted(black),
        rounded_box(0.26, 0.5, 0.72, 0.07, 4).moved(-0.19, 0, 0.6).painted(white),
        rounded_box(0.02, 0.3, 0.5, 0.008, 2).moved(-0.06, 0, 0.55).painted(grey),
        rounded_box(0.1, 0.16, 0.06, 0.02, 2).moved(0.275, 0, 0.303).painted(black),
        cylinder(0.03, 0.05, 0.004, 28).moved(0.285, 0, 0.34).painted(glass),
    ]
    for x in (0.225, -0.225):
        for y in (0.225, -0.225):
            base.append(cylinder(0.05, 0.06, 0.008, 24).moved(x, y, 0.1).painted(grey))
            base += [
                cylinder(0.074, 0.034, 0.01, 28).turned(x=90).moved(x, y + side * 0.049, 0.074).painted(rubber)
                for side in (1, -1)
            ]
    solid("base_link", base, parent=robot, physics_type="NO_COLLISION")
    empty("base_laser_link", (0.275, 0, 0.303), parent=robot, physics_type="NO_COLLISION")

    x, y, z = _TORSO
    rising = Joint("torso_lift_joint", _TORSO, (x, y, z + 0.314), (1.0, 0.0, 0.0), "")
    torso = armature("torso_armature", [rising], physics_type="NO_COLLISION")
    torso.pose.bones[rising.name].ik_stretch = _LIFT
    torso.parent = robot

    def part(holder: bpy.types.Object, bone: str, name: str, parts: list[Part]) -> None:
        # the origin is at the joint
        at = tuple(holder.matrix_world @ holder.data.bones[bone].head_local)
        moved = [each.moved(*(-value for value in at)) for each in parts]
        hang(solid(name, moved, at, physics_type="NO_COLLISION"), holder, bone)

    def limb(name: str, joints: list[Joint]) -> bpy.types.Object:
        found = armature(name, joints, physics_type="NO_COLLISION")
        hang(found, torso, rising.name)
        return found

    column = [
        rounded_box(0.24, 0.4, 0.26, 0.08, 4).moved(x, 0, z - 0.02).painted(white),
        rounded_box(0.17, 0.3, 0.24, 0.05, 3).moved(x - 0.02, 0, z + 0.2).painted(white),
        rounded_box(0.02, 0.2, 0.12, 0.008, 2).moved(x + 0.118, 0, z).painted(grey),
        lathe([(0, 0), (0.06, 0), (0.05, 0.05), (0, 0.05)], 28).moved(_NECK[0], 0, z + 0.32).painted(black),
    ]
    part(torso, rising.name, "torso_lift_link", column)
    _head(part, limb, white, black, glass)
    for side in ("l", "r"):
        holder = limb(f"{side}_arm_armature", _arm(side))
        _links(part, holder, side, white, black, steel)


def _head(part, limb, white, black, glass) -> None:
    x, y, z = _NECK
    tilt: Triple = (x + 0.068, y, z)
    head = limb(
        "head_armature",
        [
            Joint("head_pan_joint", _NECK, tilt, _UP, "z", 3.007),
            Joint("head_tilt_joint", tilt, (x + 0.137, y, z), _DOWN, "x", 1.396, -0.471),
        ],
    )
    part(head, "head_pan_joint", "head_pan_link", [
        cylinder(0.075, 0.05, 0.01, 32).moved(x, y, z - 0.005).painted(black),
        *(rounded_box(0.07, 0.025, 0.12, 0.01, 2).moved(tilt[0], s * 0.105, z + 0.03).painted(black) for s in (1, -1)),
    ])  # fmt: skip
    face = [
        rounded_box(0.16, 0.18, 0.09, 0.035, 4).moved(tilt[0] - 0.01, 0, z + 0.06).painted(white),
        rounded_box(0.08, 0.24, 0.07, 0.025, 3).moved(tilt[0] + 0.02, 0, z + 0.13).painted(white),
    ]
    for offset, radius in ((0.085, 0.018), (0.03, 0.014), (-0.03, 0.014), (-0.085, 0.018)):
        lens = cylinder(radius, 0.012, 0.002, 24).turned(y=90)
        face.append(lens.moved(tilt[0] + 0.062, offset, z + 0.13).painted(glass))
    face.append(rounded_box(0.012, 0.11, 0.03, 0.006, 2).moved(tilt[0] + 0.071, 0, z + 0.06).painted(glass))
    part(head, "head_tilt_joint", "head_tilt_link", face)


def _links(part, holder, side: str, white, black, steel) -> None:
    sign = 1 if side == "l" else -1
    x, y, z = _SHOULDER
    y *= sign

    def at(reach: float, shape: Part, up: float = 0.0) -> Part:
        return shape.moved(x + reach, y, z + up)

    part(holder, f"{side}_shoulder_pan_joint", f"{side}_shoulder_pan_link", [
        at(0.0, cylinder(0.1, 0.22, 0.02, 36), -0.03).painted(white),
        at(0.05, rounded_box(0.13, 0.15, 0.15, 0.05, 3)).painted(white),
        at(0.0, cylinder(0.07, 0.02, 0.004, 32), 0.085).painted(black),
    ])  # fmt: skip
    part(holder, f"{side}_shoulder_lift_joint", f"{side}_shoulder_lift_link", [
        at(0.1, cylinder(0.085, 0.19, 0.014, 36).turned(x=90)).painted(white),
        at(0.1, cylinder(0.06, 0.2, 0.006, 32).turned(x=90)).painted(black),
        at(0.19, cylinder(0.07, 0.09, 0.01, 32).turned(y=90)).painted(white),
    ])  # fmt: skip
    part(holder, f"{side}_upper_arm_roll_joint", f"{side}_upper_arm_link", [
        at(0.35, rounded_box(0.3, 0.14, 0.15, 0.055, 4)).painted(white),
        at(0.238, cylinder(0.06, 0.02, 0.003, 32).turned(y=90)).painted(black),
        at(0.36, rounded_box(0.18, 0.145, 0.05, 0.02, 2)).painted(black),
    ])  # fmt: skip
    part(holder, f"{side}_elbow_flex_joint", f"{side}_elbow_flex_link", [
        at(0.5, cylinder(0.065, 0.145, 0.012, 32).turned(x=90)).painted(white),
        at(0.5, cylinder(0.045, 0.155, 0.004, 28).turned(x=90)).painted(black),
    ])  # fmt: skip
    part(holder, f"{side}_forearm_roll_joint", f"{side}_forearm_link", [
        at(0.66, rounded_box(0.25, 0.105, 0.11, 0.045, 4)).painted(white),
        at(0.555, cylinder(0.05, 0.03, 0.004, 28).turned(y=90)).painted(black),
        at(0.73, rounded_box(0.04, 0.03, 0.03, 0.01, 2), 0.06).painted(black),
    ])  # fmt: skip
    part(holder, f"{side}_wrist_flex_joint", f"{side}_wrist_flex_link", [
        at(0.821, cylinder(0.036, 0.09, 0.006, 28).turned(x=90)).painted(black),
        at(0.821, sphere(0.04, 24, 14)).painted(white),
    ])  # fmt: skip
    palm = [
        at(0.9, ellipsoid(0.055, 0.05, 0.04, squareness=0.5, columns=28, rows=16)).painted(white),
        at(0.863, cylinder(0.03, 0.03, 0.004, 24).turned(y=90)).painted(black),
    ]
    for way in (1, -1):
        finger = rounded_box(0.09, 0.022, 0.024, 0.009, 2).turned(z=way * -8).moved(0, way * 0.032, 0)
        tip = box(0.035, 0.014, 0.022, 0.003).moved(0, way * 0.022, 0)
        palm += [at(0.975, finger).painted(steel), at(1.03, tip).painted(black)]
    part(holder, f"{side}_wrist_roll_joint", f"{side}_gripper_palm_link", palm)
