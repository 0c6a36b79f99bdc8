"""The joints of a model as a tree, with the constraints that close its loops."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

from morse.assets.description import Joint, Link, check_depth, settle_mimics
from morse.assets.gazebo.values import FARTHEST, ValueMistakeError, number, unlimited
from morse.assets.sdf.scope import SEPARATOR
from morse.mathutils import Matrix, Vector
from morse.scene import JointDynamics
from morse.scene.articulation import Constraint, ConstraintKind
from morse.system.free_names import free_name

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path
    from xml.etree.ElementTree import Element

    from morse.assets.sdf.scope import FlatJoint

#: rad or m, for joints without limits
_ENDLESS = 1e4
#: types of SDF, and those of the joints that they become, for each axis
_KINDS = {
    "revolute": ("revolute",),
    "continuous": ("continuous",),
    "prismatic": ("prismatic",),
    "fixed": ("fixed",),
    "ball": ("spherical",),
    "universal": ("revolute", "revolute"),
    "revolute2": ("revolute", "revolute"),
    "screw": ("revolute", "prismatic"),
    "gearbox": ("revolute",),
}
#: distance of the two points that hold the axis of a hinge that closes a loop, m
_LEVER = 0.1


class JointTree:
    """Orders the joints of a model from a root.

    Args:
        path: the file, for messages.
        poses: 4x4 of the links in the frame of the model, by name; that of the world is the identity.
        warn: receives what is left out.

    Attributes:
        joints: each after the one that moves its parent.
        constraints: of the joints that close loops.
        extra: links without mass between the axes of one joint.
    """

    def __init__(self, path: Path, poses: dict[str, Matrix], warn: Callable[[str], None]) -> None:
        self._path, self._poses, self._warn = path, poses, warn
        self.joints: list[Joint] = []
        self.constraints: list[Constraint] = []
        self.extra: list[Link] = []
        self._names: set[str] = set()
        self._of_file: set[str] = set()

    def grow(self, root: str, joints: list[FlatJoint]) -> list[FlatJoint]:
        """Add all joints that are connected with a link; return the others."""
        at: dict[str, list[FlatJoint]] = {}
        self._of_file |= {joint.name for joint in joints}
        for joint in joints:
            at.setdefault(joint.parent, []).append(joint)
            at.setdefault(joint.child, []).append(joint)
        depth, visits, queue = {root: 0}, set[int](), [root]
        for name in queue:
            # joints away from the root first, so that only loops turn a joint round
            for joint in sorted(at.get(name, ()), key=lambda one: one.parent != name):
                if id(joint) in visits:
                    continue
                visits.add(id(joint))
                other = joint.child if joint.parent == name else joint.parent
                if other in depth:
                    self._close(joint)
                    continue
                depth[other] = depth[name] + 1
                check_depth(self._path, depth[other], other)
                queue.append(other)
                self._add(joint, name, other)
        return [joint for joint in joints if id(joint) not in visits]

    def float(self, parent: str, child: str) -> None:
        """Add a joint that lets a link move freely."""
        origin = self._poses[parent].inverted() @ self._poses[child]
        free = JointDynamics(limited=False)
        self.joints.append(
            Joint(self._made(f"{child}_free"), "floating", parent, child, origin, (0.0, 0.0, 1.0), 0.0, 0.0, free)
        )

    def fix(self, parent: str, child: str) -> None:
        """Add a joint that does not move."""
        self.float(parent, child)
        self.joints[-1].kind = "fixed"

    # -- parts -------------------------------------------------------------------------------

    def _add(self, joint: FlatJoint, parent: str, child: str) -> None:
        origin = self._poses[parent].inverted() @ self._poses[child]
        anchor = self._poses[child].inverted() @ joint.pose
        # a joint that is passed from its child to its parent moves the other way round
        sign = 1.0 if child == joint.child else -1.0
        kinds = _KINDS.get(joint.kind)
        if kinds is None:
            self._warn(f"the joint '{joint.name:.80}' of the type {joint.kind[:40]!r} is fixed: this type is not read")
            kinds = ("fixed",)
        axes = list(joint.axes[: len(kinds)])
        tags = ["axis", "axis2"]
        if joint.kind == "screw":
            axes, tags = [joint.axes[0]] * 2, ["axis", "axis"]
        if sign < 0.0:
            kinds, axes, tags = kinds[::-1], axes[::-1], tags[: len(kinds)][::-1]
        names = [self._unique(joint.name), *(self._made(f"{joint.name}_axis2") for _ in kinds[1:])]
        if sign < 0.0:
            names.reverse()
        above = parent
        for number_, (kind, axis, tag) in enumerate(zip(kinds, axes or [Vector((0.0, 0.0, 1.0))], tags, strict=False)):
            last = number_ == len(kinds) - 1
            below = child if last else free_name(f"{joint.name}_middle", self._poses.__contains__)
            if not last:
                self.extra.append(Link(below))
                self._poses[below] = self._poses[child]
            one = self._joint(joint, names[number_], kind, tag, above, below)
            one.origin = origin if above == parent else Matrix.Identity(4)
            one.start = 0.0  # the links start where the file has them, also beyond the limits
            one.anchor, one.axis = anchor, tuple(sign * value for value in axis)  # type: ignore[assignment]
            self.joints.append(one)
            above = below
        if joint.kind == "screw":
            self._thread(joint)

    def _joint(self, joint: FlatJoint, name: str, kind: str, tag: str, parent: str, child: str) -> Joint:
        axis = joint.element.find(tag)
        identity = Matrix.Identity(4)
        try:
            low, high, dynamics = _limits(axis, kind)
        except ValueMistakeError as error:
            self._warn(f"the joint '{joint.name:.80}' has no limits here: {error}")
            low, high, dynamics = -_ENDLESS, _ENDLESS, JointDynamics(limited=False)
        if low > high:
            self._warn(f"the joint '{joint.name:.80}' goes from {low:g} to {high:g}; it has no limits here")
            low, high, dynamics = -_ENDLESS, _ENDLESS, replace(dynamics, limited=False)
        if kind in ("fixed", "spherical"):
            low = high = 0.0
        prefix = joint.name[: joint.name.rfind(SEPARATOR) + len(SEPARATOR)] if SEPARATOR in joint.name else ""
        follows = _mimic(axis, prefix)
        return Joint(name, kind, parent, child, identity, (0.0, 0.0, 1.0), low, high, dynamics, follows)

    def _thread(self, joint: FlatJoint) -> None:
        """Let the second joint of a screw follow the first one."""
        try:
            pitch = number(joint.element, "screw_thread_pitch", 0.0) / (2.0 * math.pi)
            # the older parameter has the unit rad/m, and the opposite sign
            pitch = pitch or -1.0 / (number(joint.element, "thread_pitch", 1.0) or 1.0)
        except ValueMistakeError as error:
            self._warn(f"the joint '{joint.name:.80}' turns only: {error}")
            pitch = 0.0
        turning = next(one for one in self.joints[-2:] if one.kind == "revolute")
        sliding = next(one for one in self.joints[-2:] if one.kind == "prismatic")
        sliding.mimic = (turning.name, pitch, 0.0)
        sliding.low, sliding.high = -_ENDLESS, _ENDLESS

    def _close(self, joint: FlatJoint) -> None:
        """Add the constraint of a joint that closes a loop."""
        parent = self._poses[joint.parent].inverted()
        if joint.parent == joint.child:
            self._warn(f"the joint '{joint.name:.80}' is left out: it connects a link with itself")
            return
        kind = joint.kind
        if kind == "gearbox":
            self._gear(joint)
            return
        points = [Vector((0.0, 0.0, 0.0))]
        if kind in ("revolute", "continuous"):
            points.append(joint.axes[0] * _LEVER)
        elif kind == "fixed":
            # of the child in the parent
            relative = parent @ self._poses[joint.child]
            rotation = tuple(relative.to_quaternion())
            data = (0.0, 0.0, 0.0, *relative.translation, *rotation, 1.0)
            self.constraints.append(Constraint(ConstraintKind.WELD, joint.parent, joint.child, data))
            return
        elif kind != "ball":
            self._warn(f"the joint '{joint.name:.80}' of the type {kind[:40]!r} is left out: it closes a loop")
            return
        for point in points:
            place = tuple(parent @ (joint.pose @ point))
            self.constraints.append(Constraint(ConstraintKind.CONNECT, joint.parent, joint.child, place))

    def _gear(self, joint: FlatJoint) -> None:
        """Couple the joints that move the two links of a gearbox."""
        moving = {one.child: one for one in self.joints}
        one, other = moving.get(joint.parent), moving.get(joint.child)
        if one is None or other is None or not (one.has_value and other.has_value):
            self._warn(f"the joint '{joint.name:.80}' is left out: no joints move the two links of the gearbox")
            return
        try:
            ratio = number(joint.element, "gearbox_ratio", 1.0)
        except ValueMistakeError as error:
            self._warn(f"the joint '{joint.name:.80}' is left out: {error}")
            return
        data = (0.0, -ratio, 0.0, 0.0, 0.0)
        self.constraints.append(Constraint(ConstraintKind.JOINT, other.name, one.name, data))

    def settle_mimics(self) -> None:
        """See `morse.assets.description.settle_mimics`."""
        settle_mimics(self.joints, self._warn)

    def _made(self, name: str) -> str:
        """A name for a joint that the file does not have; those of the file keep theirs."""
        return self._unique(free_name(name, self._of_file.__contains__))

    def _unique(self, name: str) -> str:
        unique = free_name(name, self._names.__contains__)
        self._names.add(unique)
        return unique


def _limits(axis: Element | None, kind: str) -> tuple[float, float, JointDynamics]:
    low, high = unlimited(axis, "limit/lower", -math.inf), unlimited(axis, "limit/upper", math.inf)
    if kind in ("continuous", "spherical"):
        low, high = -math.inf, math.inf
    is_limited = kind not in ("fixed", "spherical") and (low > -_ENDLESS or high < _ENDLESS)
    effort, speed = unlimited(axis, "limit/effort", -1.0), unlimited(axis, "limit/velocity", -1.0)
    return (
        max(low, -_ENDLESS),
        min(high, _ENDLESS),
        JointDynamics(
            damping=min(max(number(axis, "dynamics/damping", 0.0), 0.0), FARTHEST),
            friction=max(number(axis, "dynamics/friction", 0.0), 0.0),
            stiffness=max(number(axis, "dynamics/spring_stiffness", 0.0), 0.0),
            rest=number(axis, "dynamics/spring_reference", 0.0),
            effort=effort if 0.0 < effort < 1e16 else math.inf,
            speed=speed if 0.0 < speed < 1e16 else math.inf,
            limited=is_limited,
        ),
    )


def _mimic(axis: Element | None, prefix: str) -> tuple[str, float, float] | None:
    mimic = None if axis is None else axis.find("mimic")
    if mimic is None or not mimic.get("joint"):
        return None
    try:
        factor, reference = number(mimic, "multiplier", 1.0), number(mimic, "reference", 0.0)
        suffix = "_axis2" if mimic.get("axis") == "axis2" else ""
        return f"{prefix}{mimic.get('joint')}{suffix}", factor, number(mimic, "offset", 0.0) - factor * reference
    except ValueMistakeError:
        return None
