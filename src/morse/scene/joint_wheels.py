"""Wheels that are joints of a robot: where they are, and how large."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from morse.mathutils.portable import matmul
from morse.scene import JointKind
from morse.scene.articulation import start_frames
from morse.scene.body import ShapeKind
from morse.scene.frames import rigid_frame

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    import numpy.typing as npt

    from morse.scene import Bone, Node
    from morse.scene.articulation import JointDynamics
    from morse.scene.body import CollisionShape
    from morse.scene.frames import RigidFrame

    _Points = npt.NDArray[np.float64]

#: cosine of the largest angle between an axle and the Y axis of the robot
_ALONG = 0.9
#: a wheel that touches the ground is at most this part of its radius above the lowest one
_ABOVE = 0.25
#: points on a circle
_CORNERS = 24
#: wheels nearer to the middle than this part of the largest distance turn nothing
_MIDDLE = 0.2
#: what ends at most this much above the ground, m, drags on it
_TOUCHES = 0.001
#: sine of the smallest angle between the axis of a joint that steers and the ground: the joints of a leg do not
_STEERS = 0.7
#: largest difference of the sides of a box around a wheel, as a part of its radius
_SQUARE = 0.05
#: largest distance of the axle from the middle of a wheel, as a part of its radius: the shank of a leg is no wheel
_CENTRED = 0.2
#: largest distance of what further joints carry from the axle, as a part of the radius: rollers, but no shank
_CARRIED = 1.5


@dataclass(frozen=True, slots=True)
class JointWheel:
    """A wheel, in the frame of the robot.

    Attributes:
        joint: name of its joint.
        x, y, z: its centre, m.
        radius: m; 0 if it has no shape.
        along: cosine of the angle between its axis and the Y axis: 1 if it rolls forward at positive speeds.
        is_endless: whether it turns without limits.
        carrier: the joint that steers it, as in a caster or a steered wheel; empty for none.
        is_centred: whether the axle is in the middle of its shapes, and what it carries is not far from it.
        rounds: nodes and shapes that are cylinders about the axle, or boxes in their place.
        friction: coefficient of its shapes in the file; None for the default.
        dynamics: of its joint; None if the physics does not move it.
    """

    joint: str
    x: float
    y: float
    z: float
    radius: float
    along: float
    is_endless: bool
    carrier: str
    is_centred: bool = True
    rounds: tuple[tuple[Node, CollisionShape], ...] = ()
    friction: float | None = None
    dynamics: JointDynamics | None = None

    @property
    def is_driven(self) -> bool:
        """Whether it can be a driven wheel."""
        return self.is_endless and self.is_centred and not self.carrier

    @property
    def is_lateral(self) -> bool:
        """Whether it has shapes, about an axle along the Y axis of the robot."""
        return abs(self.along) > _ALONG and self.radius > 0.0


def joint_wheels(robot: Node) -> list[JointWheel]:
    """The joints of a robot that turn, as wheels, as they are at the start."""
    wheels = []
    base = rigid_frame(robot)
    for armature in robot.walk():
        bones = armature.bones
        if not bones:
            continue
        frames = start_frames(bones)
        place, turn = _relative(armature, base)
        links = {child.bone: child for child in armature.children if child.bone}
        axes = [
            matmul(turn, np.array(frame).reshape(3, 3)[:, bone.axis])
            for bone, (_, frame) in zip(bones, frames, strict=True)
        ]
        for index, bone in enumerate(bones):
            if bone.kind is not JointKind.REVOLUTE:
                continue
            axis, origin = axes[index], matmul(turn, np.array(frames[index][0])) + place
            behind = _behind(bones, index)
            whole = [links[one.name] for one, is_rigid in behind if is_rigid and one.name in links]
            centre, radius, is_centred, rounds = _extent(whole, base, origin, axis)
            x, y, z = centre.tolist()
            for carried in [links[one.name] for one, is_rigid in behind if not is_rigid and one.name in links]:
                for _, _, _, points in _clouds(carried, base):
                    is_centred = is_centred and _distances(points - origin, axis).max() < _CARRIED * radius
            is_endless = bone.dynamics is not None and not bone.dynamics.limited and bone.leader < 0
            carrier = _carrier(bones, index, axes)
            frictions = [part.body.friction for link in whole for part in _parts(link) if part.shapes]
            wheels.append(
                JointWheel(
                    bone.name,
                    x,
                    y,
                    z,
                    radius,
                    float(axis[1]),
                    is_endless,
                    carrier,
                    is_centred,
                    rounds,
                    min((one for one in frictions if one is not None), default=None),
                    bone.dynamics,
                )
            )
    return wheels


def driven_wheels(wheels: Sequence[JointWheel]) -> tuple[list[JointWheel], list[JointWheel]]:
    """The wheels on the left and on the right that a differential drive turns; empty if there are none."""
    lateral = [one for one in wheels if one.is_endless and one.is_lateral]
    lowest = min((one.z - one.radius for one in lateral), default=0.0)
    largest = max((one.radius for one in lateral if one.is_driven), default=0.0)
    # rollers, rotors above the ground, and motors above the shanks of legs are no wheels
    axles = [
        one
        for one in lateral
        if one.is_driven and one.z - one.radius < lowest + _ABOVE * one.radius and one.radius > 0.5 * largest
    ]
    if not axles:
        return [], []
    middle = 0.5 * (max(one.y for one in axles) + min(one.y for one in axles))
    half = max(one.y for one in axles) - middle
    sides = [(one, one.y - middle) for one in axles if abs(one.y - middle) > max(_MIDDLE * half, 1e-3)]
    return [one for one, y in sides if y > 0.0], [one for one, y in sides if y < 0.0]


def mass_and_centre(robot: Node) -> tuple[float, float | None]:
    """The mass of the links of a robot, kg, and the x coordinate of its centre in its frame, m, None without a mass."""
    base, total, moment = rigid_frame(robot), 0.0, 0.0
    for node in robot.walk():
        if node.inertial is not None:
            place, turn = _relative(node, base)
            x = float(place[0] + matmul(turn, np.array(node.inertial.centre))[0])
            total, moment = total + node.inertial.mass, moment + node.inertial.mass * x
    return total, moment / total if total else None


def dragging_links(robot: Node, driven: Sequence[JointWheel]) -> list[tuple[str, float]]:
    """The links behind joints with limits that reach the ground on which wheels stand, and how far below it, m."""
    ground = min(one.z - one.radius for one in driven)
    base, found = rigid_frame(robot), []
    for armature in robot.walk():
        limited: set[str] = set()
        rolling = {wheel.joint for wheel in driven}
        for bone in armature.bones:
            if bone.name in rolling or (bone.parent >= 0 and armature.bones[bone.parent].name in rolling):
                rolling.add(bone.name)
                continue
            moves = bone.kind is not JointKind.FIXED and bone.dynamics is not None and bone.dynamics.limited
            if moves or (bone.parent >= 0 and armature.bones[bone.parent].name in limited):
                limited.add(bone.name)
        for link in armature.children:
            clouds = [points for _, _, _, points in _clouds(link, base)] if link.bone in limited else []
            lowest = min((float(points[:, 2].min()) for points in clouds), default=ground + 1.0)
            if lowest < ground + _TOUCHES:
                found.append((link.name.rpartition("/")[2], ground - lowest))
    return found


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


def _carrier(bones: Sequence[Bone], index: int, axes: Sequence[_Points]) -> str:
    above = bones[index].parent
    while above >= 0:
        if bones[above].kind.is_loose or (bones[above].kind is JointKind.REVOLUTE and abs(axes[above][2]) > _STEERS):
            return bones[above].name
        above = bones[above].parent
    return ""


def _behind(bones: Sequence[Bone], index: int) -> list[tuple[Bone, bool]]:
    """A bone and those behind it, and whether they are fixed to it, as tyres are to the hubs of some files."""
    found = {index: True}
    for other, bone in enumerate(bones):
        if bone.parent in found:
            found[other] = found[bone.parent] and bone.kind is JointKind.FIXED
    return [(bones[other], is_rigid) for other, is_rigid in found.items()]


def _relative(node: Node, base: RigidFrame) -> tuple[_Points, _Points]:
    """Position (3,) and rotation (3, 3) of a node in a frame."""
    own, inverse = rigid_frame(node), _array(base.rotation).T
    return matmul(inverse, np.array(own.position) - np.array(base.position)), matmul(inverse, _array(own.rotation))


def _array(matrix: Iterable[Iterable[float]]) -> _Points:
    return np.array([list(row) for row in matrix])


def _extent(
    links: Sequence[Node], base: RigidFrame, origin: _Points, axis: _Points
) -> tuple[_Points, float, bool, tuple[tuple[Node, CollisionShape], ...]]:
    """The centre of a wheel in the frame of the robot, its radius, m, whether the axle is there, and round shapes."""
    clouds: list[_Points] = []
    rounds: list[tuple[Node, CollisionShape]] = []
    for node, shape, turn, cloud in (part for link in links for part in _clouds(link, base)):
        points = cloud - origin
        if _is_round(shape, turn, points.mean(axis=0), axis):
            rounds.append((node, shape))
            if shape.kind is ShapeKind.BOX:
                # the middles of the sides, not the corners, are on the tread
                middle = points.mean(axis=0)
                across = points - middle - np.outer(matmul(points - middle, axis), axis)
                points = points - across * (1.0 - math.sqrt(0.5))
        clouds.append(points)
    if not clouds:
        return origin, 0.0, True, ()
    points = np.concatenate(clouds)
    height = matmul(points, axis)
    across = points - np.outer(height, axis)
    radius = float(_distances(points, axis).max())
    is_centred = math.hypot(*(across.max(axis=0) + across.min(axis=0)).tolist()) < 2.0 * _CENTRED * radius
    return origin + axis * (height.max() + height.min()) / 2.0, radius, is_centred, tuple(rounds)


def _distances(points: _Points, axis: _Points) -> _Points:
    """The distances (N,) of points (N, 3) from an axis through the origin."""
    return np.asarray(np.linalg.norm(points - np.outer(matmul(points, axis), axis), axis=1))


def _clouds(link: Node | None, base: RigidFrame) -> Iterator[tuple[Node, CollisionShape, _Points, _Points]]:
    """The shapes of a link and of what is fixed to it: their rotations (3, 3) and points (N, 3) in a frame."""
    for node in _parts(link):
        place, turn = _relative(node, base)
        for shape in node.shapes or ():
            rotation, points = np.array(shape.rotation).reshape(3, 3), _points(shape)
            if shape.kind is not ShapeKind.CONVEX:
                points = matmul(points, rotation.T) + np.array(shape.position)
            yield node, shape, matmul(turn, rotation), matmul(points, turn.T) + place


def _is_round(shape: CollisionShape, rotation: _Points, centre: _Points, axis: _Points) -> bool:
    """Whether a shape is a cylinder about an axle, or a box that is square across it."""
    if shape.kind not in (ShapeKind.BOX, ShapeKind.CYLINDER):
        return False
    along = np.abs(matmul(rotation.T, axis))
    side = int(along.argmax())
    half = shape.size if shape.kind is ShapeKind.BOX else (shape.size[0], shape.size[0], shape.size[1])
    one, other = (half[i] for i in range(3) if i != side)
    off = centre - axis * float((centre * axis).sum())
    return bool(
        along[side] > 1.0 - 1e-3
        and (side == 2 or shape.kind is ShapeKind.BOX)
        and abs(one - other) < _SQUARE * one
        and math.sqrt(float((off * off).sum())) < _CENTRED * one
    )


def _parts(link: Node | None) -> Iterator[Node]:
    """A link and what is fixed to it."""
    return (node for node in link.walk() if not node.bones) if link is not None else iter(())


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
