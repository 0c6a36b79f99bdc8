"""Wheels that are joints of a robot: where they are, and how large."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from morse.helpers.chain import Chain
from morse.helpers.transformation import Transformation3d
from morse.mathutils.portable import matmul
from morse.mathutils.rotations import rows_of
from morse.scene import JointKind
from morse.scene.shapes import ShapeKind

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    import numpy.typing as npt

    from morse.core.values import Fields
    from morse.core.world import Body
    from morse.scene import Bone
    from morse.scene.shapes import CollisionShape

    _Points = npt.NDArray[np.float64]

#: unit and range of the properties of drives that are lengths of wheels, or between wheels
WHEEL_LENGTH: Fields = {"unit": "m", "low": 0.0, "high": 100.0}
#: cosine of the largest angle between an axle and the Y axis of the robot
_ALONG = 0.9
#: a wheel that touches the ground is at most this part of its radius above the lowest one
_ABOVE = 0.25
#: points on a circle
_CORNERS = 24
#: wheels nearer to the middle than this part of the largest distance turn nothing
_MIDDLE = 0.2


@dataclass(frozen=True, slots=True)
class JointWheel:
    """A wheel, in the frame of the robot.

    Attributes:
        joint: name of its joint.
        x, y, z: its centre, m.
        radius: m; 0 if it has no shape.
        along: cosine of the angle between its axis and the Y axis: 1 if it rolls forward at positive speeds.
        is_endless: whether it turns without limits.
        carrier: the joint that turns and carries it, as in a caster or a steered wheel; empty for none.
    """

    joint: str
    x: float
    y: float
    z: float
    radius: float
    along: float
    is_endless: bool
    carrier: str

    @property
    def is_driven(self) -> bool:
        """Whether it can be a driven wheel."""
        return self.is_endless and not self.carrier


def joint_wheels(robot: Body) -> list[JointWheel]:
    """The joints of a robot that turn, as wheels."""
    wheels = []
    base = Transformation3d(robot)
    for armature in (robot, *robot.childrenRecursive):
        bones = armature.node.bones
        if not bones:
            continue
        chain = Chain(bones)
        frames = chain.frames(chain.start)
        place = base.transformation3d_with(Transformation3d(armature))
        links = {child.node.bone: child for child in armature.children if child.node.bone}
        turn = np.array(rows_of(place.get_pose()[1]))
        for index, bone in enumerate(bones):
            if bone.kind is not JointKind.REVOLUTE:
                continue
            position, rotation = frames[index]
            axis = matmul(turn, np.array(rotation).reshape(3, 3)[:, bone.axis])
            origin = matmul(turn, np.array(position)) + np.array(place.get_pose()[0])
            centre, radius = _extent(links.get(bone.name), base, origin, axis)
            x, y, z = centre.tolist()
            is_endless = bone.dynamics is not None and not bone.dynamics.limited and bone.leader < 0
            wheels.append(JointWheel(bone.name, x, y, z, radius, float(axis[1]), is_endless, _carrier(bones, index)))
    return wheels


def driven_wheels(wheels: Sequence[JointWheel]) -> tuple[list[JointWheel], list[JointWheel]]:
    """The wheels on the left and on the right that a differential drive turns; empty if there are none."""
    axles = [one for one in wheels if one.is_driven and abs(one.along) > _ALONG and one.radius > 0.0]
    if not axles:
        return [], []
    # rollers, and rotors above the ground, are no wheels
    lowest = min(one.z - one.radius for one in axles)
    largest = max(one.radius for one in axles)
    axles = [one for one in axles if one.z - one.radius < lowest + _ABOVE * one.radius and one.radius > 0.5 * largest]
    middle = 0.5 * (max(one.y for one in axles) + min(one.y for one in axles))
    half = max(one.y for one in axles) - middle
    sides = [(one, one.y - middle) for one in axles if abs(one.y - middle) > max(_MIDDLE * half, 1e-3)]
    return [one for one, y in sides if y > 0.0], [one for one, y in sides if y < 0.0]


def rolling_wheels(wheels: Sequence[JointWheel], driven: Sequence[str]) -> list[str]:
    """The joints on the ground that roll freely beside driven wheels, and those that let casters swivel."""
    turned = [one for one in wheels if one.joint in driven and one.radius > 0.0]
    if not turned:
        return []
    ground = max(one.z - one.radius + _ABOVE * one.radius for one in turned)
    free = {one.joint: one for one in wheels if one.is_endless and one.joint not in driven}
    rolling = [one for one in free.values() if one.radius > 0.0 and one.z - one.radius < ground]
    carriers = [one.carrier for one in rolling if one.carrier in free]
    return [*dict.fromkeys([*(one.joint for one in rolling), *carriers])]


def _carrier(bones: Sequence[Bone], index: int) -> str:
    above = bones[index].parent
    while above >= 0:
        if bones[above].kind is not JointKind.FIXED and bones[above].kind is not JointKind.PRISMATIC:
            return bones[above].name
        above = bones[above].parent
    return ""


def _extent(link: Body | None, base: Transformation3d, origin: _Points, axis: _Points) -> tuple[_Points, float]:
    """The centre of a wheel in the frame of the robot, and its radius, m."""
    clouds = list(_clouds(link, base)) if link is not None else []
    if not clouds:
        return origin, 0.0
    points = np.concatenate(clouds) - origin
    height = matmul(points, axis)
    radial = np.linalg.norm(points - np.outer(height, axis), axis=1)
    return origin + axis * (height.max() + height.min()) / 2.0, float(radial.max())


def _clouds(link: Body, base: Transformation3d) -> Iterator[_Points]:
    for part in (link, *link.childrenRecursive):
        if part.node.bones:
            continue
        place = base.transformation3d_with(Transformation3d(part))
        position, quaternion = place.get_pose()
        turn = np.array(rows_of(quaternion))
        for shape in part.node.shapes or ():
            points = _points(shape)
            if shape.kind is not ShapeKind.CONVEX:
                points = matmul(points, np.array(rows_of(shape.rotation)).T) + np.array(shape.position)
            yield matmul(points, turn.T) + np.array(position)


def _points(shape: CollisionShape) -> _Points:
    """Points on the surface of a shape, (N, 3)."""
    if shape.kind is ShapeKind.CONVEX:
        return np.asarray(shape.vertices, dtype=np.float64)
    size = shape.size
    if shape.kind is ShapeKind.BOX:
        return np.array(
            [[x * size[0], y * size[1], z * size[2]] for x, y, z in itertools.product((-1.0, 1.0), repeat=3)]
        )
    angles = [math.tau * number / _CORNERS for number in range(_CORNERS)]
    circle = np.array([[size[0] * math.cos(angle), size[0] * math.sin(angle), 0.0] for angle in angles])
    if shape.kind in (ShapeKind.CYLINDER, ShapeKind.CAPSULE):
        height = np.array([0.0, 0.0, size[1]])
        return np.concatenate([circle + height, circle - height])
    return np.concatenate([circle, np.roll(circle, 1, axis=1), np.roll(circle, 2, axis=1)])
