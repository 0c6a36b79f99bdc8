"""A person who stands upright with slightly spread arms; the skeleton has joints in the limbs and the spine."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from common.armatures import Joint, armature, hang
from common.colors import NAVY, TEAL
from common.materials import material
from common.objects import empty, hidden_box, hidden_shape, solid
from common.shapes import cylinder, ellipsoid, lathe, rounded_box, sphere, tube

if TYPE_CHECKING:
    import bpy
    from common.objects import Triple
    from common.parts import Part

_UP, _AHEAD = (0.0, 0.0, 1.0), (1.0, 0.0, 0.0)
_SPREAD = math.radians(25.0)
_HIP, _KNEE, _ANKLE = 0.90, 0.49, 0.085
_SHOULDER = (0.0, 0.185, 1.40)


def _arm(along: float) -> Triple:
    """A point of the left arm, at a distance from the shoulder."""
    x, y, z = _SHOULDER
    return (x, y + along * math.sin(_SPREAD), z - along * math.cos(_SPREAD))


def _right(point: Triple) -> Triple:
    return (point[0], -point[1], point[2])


def _spine() -> list[Joint]:
    """Bones that point up, with Z ahead and X at the left: a positive angle about X leans forward."""
    heights = (
        ("root", 0.93, 0.99, "", 0.0),
        ("spine05", 0.99, 1.06, "x", 0.7),
        ("spine04", 1.06, 1.12, "", 0.0),
        ("spine03", 1.12, 1.19, "z", 0.5),
        ("spine02", 1.19, 1.26, "", 0.0),
        ("spine01", 1.26, 1.42, "y", 0.7),
        ("neck01", 1.42, 1.46, "z", 0.6),
        ("neck02", 1.46, 1.50, "x", 0.9),
        ("neck03", 1.50, 1.54, "y", 1.4),
        ("head", 1.54, 1.74, "", 0.0),
    )
    return [Joint(name, (0, 0, low), (0, 0, high), _AHEAD, axis, limit) for name, low, high, axis, limit in heights]


def _left_limbs() -> list[Joint]:
    return [
        # limbs that point down have X at the right: a positive angle about it swings them forward. An arm swings about
        # its collar bone, and is raised sideways at the shoulder
        Joint("clavicle_L", (0, 0.03, 1.40), (0, 0.165, 1.40), _UP, "y", 0.8, -3.0, "spine01"),
        Joint("shoulder01_L", (0, 0.165, 1.40), _SHOULDER, _UP, "x", 2.4, -0.4),
        Joint("shoulder02_L", _SHOULDER, _arm(0.09), _AHEAD, "y", 1.6),
        Joint("upperarm02_L", _arm(0.09), _arm(0.29), _AHEAD, ""),
        Joint("lowerarm01_L", _arm(0.29), _arm(0.41), _AHEAD, "x", 2.5, 0.0),
        Joint("lowerarm02_L", _arm(0.41), _arm(0.53), _AHEAD, "y", 1.6),
        Joint("wrist_L", _arm(0.53), _arm(0.70), _AHEAD, "z", 1.2),
        Joint("pelvis_L", (0, 0.09, _HIP + 0.02), (0, 0.09, _HIP), _AHEAD, "z", 0.8, -0.8, "root"),
        Joint("upperleg01_L", (0, 0.09, _HIP), (0, 0.09, _HIP - 0.08), _AHEAD, "x", 2.0, -0.6),
        Joint("upperleg02_L", (0, 0.09, _HIP - 0.08), (0, 0.09, _KNEE), _AHEAD, "y", 0.7),
        Joint("lowerleg01_L", (0, 0.09, _KNEE), (0, 0.09, 0.28), _AHEAD, "x", 0.0, -2.5),
        Joint("lowerleg02_L", (0, 0.09, 0.28), (0, 0.09, _ANKLE), _AHEAD, "y", 0.4),
        Joint("foot_L", (0, 0.09, _ANKLE), (0.15, 0.09, 0.03), _UP, "x", 0.8),
    ]


def _mirrored(joint: Joint) -> Joint:
    """The same joint at the right: turns about the bone and about the direction ahead change their sign."""
    parent = None if joint.parent is None else joint.parent.replace("_L", "_R")
    low, high = -joint.limit if joint.low is None else joint.low, joint.limit
    if joint.axis in ("y", "z"):
        low, high = -high, -low
    name = joint.name.replace("_L", "_R")
    return Joint(name, _right(joint.head), _right(joint.tail), joint.z_axis, joint.axis, high, low, parent)


def build() -> None:
    body = empty("Human", physics_type="DYNAMIC", mass=50.0)
    left = _left_limbs()
    skeleton = armature("HumanSkeleton", [*_spine(), *left, *map(_mirrored, left)], physics_type="NO_COLLISION", gait=1)
    skeleton.parent = body
    hidden_box("human_base_bb", (0.3, 0.487, 0.9), (0.02, 0, 0.45), parent=body, physics_type="DYNAMIC", mass=1.0)
    for name, bone, shape, kind, height in (
        ("torso_bb", "spine01", cylinder(0.17, 0.5), "cylinder", 1.17),
        ("head_bb", "head", sphere(0.11, 16, 8), "sphere", 1.63),
    ):
        hidden = hidden_shape(name, [shape], (0, 0, height), physics_type="STATIC", collision=kind, internal=1)
        hang(hidden, skeleton, bone)
    skin, shirt = material("Skin", "#e0a47e", 0.6), material("Shirt", TEAL, 0.8)
    trousers, shoe = material("Trousers", "#40506a", 0.85), material("Shoes", NAVY, 0.7)
    hair, dark, white = (
        material("Hair", "#4b2e1e", 0.8),
        material("Dark", "#20252b", 0.4),
        material("Eye", "#f4f3ee", 0.3),
    )

    def part(bone: str, name: str, parts: list[Part]) -> bpy.types.Object:
        # the origin is at the joint
        x, y, z = skeleton.data.bones[bone].head_local
        found = solid(name, [each.moved(-x, -y, -z) for each in parts], (x, y, z), physics_type="NO_COLLISION")
        hang(found, skeleton, bone)
        return found

    part("root", "hips_mesh", [ellipsoid(0.125, 0.175, 0.12, squareness=0.3).moved(z=0.94).painted(trousers)])
    part("spine05", "belly_mesh", [ellipsoid(0.12, 0.165, 0.15, squareness=0.3).moved(z=1.08).painted(shirt)])
    chest = [
        ellipsoid(0.13, 0.2, 0.2, squareness=0.3, columns=32, rows=20).moved(z=1.27).painted(shirt),
        tube([(0, 0, 1.38), (0.004, 0, 1.47)], 0.055, 16).painted(skin),
    ]
    part("spine01", "chest_mesh", chest)
    part("neck01", "neck_mesh", [tube([(0, 0, 1.42), (0.006, 0, 1.56)], 0.05, 16).painted(skin)])
    face = [
        ellipsoid(0.105, 0.085, 0.13, squareness=0.1, columns=32, rows=20).moved(0.012, 0, 1.62).painted(skin),
        ellipsoid(0.11, 0.092, 0.1, columns=28, rows=14).moved(-0.014, 0, 1.68).painted(hair),
        ellipsoid(0.018, 0.014, 0.024, columns=14, rows=8).moved(0.118, 0, 1.605).painted(skin),
        rounded_box(0.012, 0.05, 0.008, 0.003, 2).moved(0.102, 0, 1.553).painted(dark),
    ]
    for side in (1, -1):
        face += [
            sphere(0.014, 14, 8).moved(0.105, side * 0.034, 1.64).painted(white),
            sphere(0.008, 12, 8).moved(0.114, side * 0.034, 1.64).painted(dark),
            sphere(0.024, 12, 8).scaled(0.6, 0.5, 1.0).moved(0.0, side * 0.086, 1.62).painted(skin),
        ]
    part("head", "head_mesh", face)
    for letter, mirror in (("L", lambda point: point), ("R", _right)):
        side = 1 if letter == "L" else -1

        def line(*points: Triple, mirror=mirror) -> list[Triple]:
            return [mirror(point) for point in points]

        def limb(bone: str, name: str, parts: list[Part], letter: str = letter) -> None:
            part(f"{bone}_{letter}", f"{name}_{letter}_mesh", parts)

        limb(
            "upperarm02",
            "upperarm",
            [tube(line(_arm(0.0), _arm(0.15), _arm(0.285)), [0.061, 0.055, 0.051], 18).painted(shirt)],
        )
        limb("shoulder01", "shoulder", [sphere(0.061, 20, 12).moved(*mirror(_SHOULDER)).painted(shirt)])
        limb(
            "lowerarm02",
            "lowerarm",
            [
                sphere(0.046, 16, 10).moved(*mirror(_arm(0.29))).painted(skin),
                tube(line(_arm(0.29), _arm(0.4), _arm(0.53)), [0.043, 0.041, 0.03], 18).painted(skin),
            ],
        )
        tilt = math.degrees(_SPREAD) * side
        palm = ellipsoid(0.042, 0.02, 0.06, squareness=0.2, columns=20, rows=12).turned(x=tilt)
        hand = [palm.moved(*mirror(_arm(0.59))).painted(skin)]
        for offset, end in ((-0.027, 0.69), (-0.009, 0.71), (0.009, 0.715), (0.027, 0.70)):
            root, tip = mirror(_arm(0.63)), mirror(_arm(end))
            finger = [(offset, *root[1:]), (offset, *tip[1:])]
            hand.append(tube(finger, [0.0095, 0.0075], 10).painted(skin))
        thumb = line((0.03, *_arm(0.56)[1:]), (0.062, *_arm(0.62)[1:]))
        hand.append(tube(thumb, [0.012, 0.009], 10).painted(skin))
        limb("wrist", "hand", hand)
        y = 0.09 * side
        limb(
            "upperleg02",
            "upperleg",
            [
                sphere(0.093, 20, 12).moved(0, y, _HIP).painted(trousers),
                tube([(0, y, _HIP), (0, y, 0.7), (0, y, _KNEE)], [0.09, 0.075, 0.058], 20).painted(trousers),
            ],
        )
        limb(
            "lowerleg02",
            "lowerleg",
            [
                sphere(0.058, 18, 12).moved(0, y, _KNEE).painted(trousers),
                tube([(0, y, _KNEE), (-0.012, y, 0.36), (0, y, 0.11)], [0.056, 0.058, 0.042], 20).painted(trousers),
                lathe([(0.046, 0.0), (0.05, 0.005), (0.05, 0.03), (0.046, 0.035)], 20)
                .moved(0, y, 0.1)
                .painted(trousers),
            ],
        )
        sole = [
            rounded_box(0.25, 0.095, 0.03, 0.012, 2).moved(0.05, y, 0.015).painted(dark),
            ellipsoid(0.125, 0.047, 0.05, squareness=0.35, columns=24, rows=12).moved(0.05, y, 0.045).painted(shoe),
            ellipsoid(0.055, 0.045, 0.05, squareness=0.2, columns=20, rows=12).moved(-0.012, y, 0.085).painted(shoe),
        ]
        limb("foot", "foot", sole)
