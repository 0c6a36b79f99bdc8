"""What robots with driven wheels stand on beside these: casters, skids, and the body itself.

A robot with two driven wheels and rigid casters stands on three points. Casters that reach a millimetre too low lift a
driven wheel, and the robot turns on the spot or does not move. Real casters have springs, and roll or swivel. In the
simulation, what is rigid and reaches the ground beside the wheels slides without friction, and ends slightly higher
than the wheels, so that the wheels always carry a load. Casters with joints roll, and what has a friction in its file
keeps this and its place.

Supports are found by their geometry: they end at the height of the wheels.
"""

from __future__ import annotations

import logging
from dataclasses import replace
from typing import TYPE_CHECKING
from weakref import WeakKeyDictionary

import numpy as np

from morse.mathutils.portable import matmul
from morse.physics.model.layout import Motion, driven_wheels
from morse.physics.model.shapes import wheel_axis, wheel_size
from morse.physics.poses.rigid import relative_pose
from morse.scene import ShapeKind
from morse.scene.extent import box_around
from morse.scene.frames import rigid_frame
from morse.scene.joint_wheels import driven_wheels as wheels_on_joints
from morse.scene.joint_wheels import joint_wheels

if TYPE_CHECKING:
    from collections.abc import Iterable

    from morse.physics.model.layout import Frame
    from morse.scene import CollisionShape, Node
    from morse.scene.joint_wheels import JointWheel

logger = logging.getLogger(__name__)

#: distance between the lowest points of supports and wheels, m
_CLEARANCE = 0.001
#: what ends at most this much above the wheels supports the robot, m
_NEAR = 0.01
#: friction of casters in files that slide
_SLIPPERY = 0.02
#: what ends lower than this part of the radius below the wheels is no support: the wheels hang in the air
_BELOW = 0.25

#: heights of the supports of frames, which are asked for by several parts
_known: WeakKeyDictionary[Frame, dict[Node, float]] = WeakKeyDictionary()


def supports(frame: Frame) -> dict[Node, float]:
    """Return the parts of a robot that slide on the ground beside its driven wheels, and how far each is raised, m."""
    found = _known.get(frame)
    if found is None:
        found = _known[frame] = dict(_supports(frame))
    return found


def _supports(frame: Frame) -> Iterable[tuple[Node, float]]:
    if frame.robot is None or frame.motion is not Motion.FREE:
        return
    bottoms = _wheels(frame)
    if not bottoms:
        return
    pose = rigid_frame(frame.node)
    ground = max(bottom for bottom, _ in bottoms)
    lowest = ground - _BELOW * min(radius for _, radius in bottoms)
    for node in frame.solid:
        if (node.body.friction or 0.0) > _SLIPPERY and frame.node.articulation is not None:
            continue
        low = min(
            (float(box_around(shape, *relative_pose(node, pose))[0][2]) for shape in node.shapes or ()), default=1e9
        )
        if lowest < low < ground + _NEAR:
            yield node, max(0.0, ground + _CLEARANCE - low)


def _wheels(frame: Frame) -> list[tuple[float, float]]:
    """The lowest points of the driven wheels of a robot, in its frame, and their radii, m."""
    pose, names = rigid_frame(frame.node), driven_wheels(frame.robot)
    found = []
    for node in frame.node.walk() if names else ():
        if node.name in names:
            radius, _, _ = wheel_size(node, wheel_axis(node, frame.node))
            found.append((float(relative_pose(node, pose)[0][2]) - radius, radius))
    return found or [(wheel.z - wheel.radius, wheel.radius) for wheel in _joint_wheels(frame)]


def _joint_wheels(frame: Frame) -> list[JointWheel]:
    """The wheels of a robot of a file that a differential drive turns; what MuJoCo's own files say is kept."""
    articulation = frame.node.articulation
    if articulation is None or articulation.model is not None or not frame.carries:
        return []
    left, right = wheels_on_joints(joint_wheels(frame.node))
    return [*left, *right] if left and right else []


def wheel_joints(frames: Iterable[Frame]) -> dict[Frame, set[str]]:
    """Return the names of the joints of the driven wheels of each robot of a file."""
    robots = [frame for frame in frames if frame.robot is not None and frame.motion is Motion.FREE]
    return {frame: {wheel.joint for wheel in _joint_wheels(frame)} for frame in robots}


def round_wheels(frames: Iterable[Frame]) -> dict[CollisionShape, CollisionShape]:
    """Make the driven wheels of robots of files roll on one point each.

    A cylinder touches the ground with an edge on each side, whose loads depend on rounding, and scrubs in a turn. A
    box, which some files have in place of a wheel, does not roll: it becomes a cylinder in the scene, with a warning.

    Returns:
        The ellipsoid in each cylinder.
    """
    ellipsoids: dict[CollisionShape, CollisionShape] = {}
    for frame in frames:
        if frame.robot is None or frame.motion is not Motion.FREE:
            continue
        boxes = []
        for wheel in _joint_wheels(frame):
            for node, shape in wheel.rounds:
                cylinder = shape
                if shape.kind is ShapeKind.BOX:
                    boxes.append(wheel.joint)
                    cylinder = _rolling(shape, node, frame)
                    node.shapes = [cylinder if one is shape else one for one in node.shapes or ()]
                radius, half = cylinder.size
                ellipsoids[cylinder] = replace(cylinder, kind=ShapeKind.ELLIPSOID, size=(radius, radius, half))
        if boxes:
            logger.warning(
                "%s: the wheels of the joints %s are boxes in the file, which do not roll; they collide as cylinders",
                frame.node.plain_name,
                ", ".join(dict.fromkeys(f"'{joint}'" for joint in boxes)),
                extra={"where": frame.node.line},
            )
    return ellipsoids


def _rolling(shape: CollisionShape, node: Node, frame: Frame) -> CollisionShape:
    """Return the cylinder in a box, about the axis that is nearest to the Y axis of the robot."""
    turned = matmul(relative_pose(node, rigid_frame(frame.node))[1], np.reshape(shape.rotation, (3, 3)))
    axle = int(np.abs(turned[1]).argmax())
    order = [(axle + 1) % 3, (axle + 2) % 3, axle]
    rotation = np.reshape(shape.rotation, (3, 3))[:, order]
    radius = max(shape.size[order[0]], shape.size[order[1]])
    a, b, c, d, e, f, g, h, i = rotation.ravel().tolist()
    return replace(
        shape, kind=ShapeKind.CYLINDER, size=(radius, shape.size[axle]), rotation=(a, b, c, d, e, f, g, h, i)
    )
