"""Joints that the physics moves: the masses of links, and the friction, limits and motors of joints."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from enum import StrEnum
from typing import TYPE_CHECKING

from morse.mathutils.rotations import Rotation9, product, turn
from morse.scene.mjcf import MjcfModel  # noqa: TC001 (recordings read the annotations)

if TYPE_CHECKING:
    from collections.abc import Sequence


class JointKind(StrEnum):
    """How a bone moves relative to its parent."""

    FIXED = "fixed"
    REVOLUTE = "revolute"
    PRISMATIC = "prismatic"
    BALL = "ball"
    PLANAR = "planar"
    FLOATING = "floating"

    @property
    def has_value(self) -> bool:
        """Whether one number, rad or m, gives the pose of the bone."""
        return self in (JointKind.REVOLUTE, JointKind.PRISMATIC)

    @property
    def is_loose(self) -> bool:
        """Whether the bone moves in several directions, and has no motor."""
        return self in (JointKind.BALL, JointKind.PLANAR, JointKind.FLOATING)


@dataclass(frozen=True, slots=True)
class Bone:
    """A bone, and the joint at its root.

    The frame of a bone has its origin at the joint and its Y axis along the bone. ``position`` and ``rotation`` are the
    pose of that frame at joint value 0.

    Attributes:
        name: unique within the armature.
        parent: index of the parent bone, or -1 for the armature itself.
        position: metres, in the frame of the parent.
        rotation: 9 numbers, row by row, from the frame of the bone to that of the parent.
        length: metres.
        kind: revolute joints turn about ``axis``, prismatic ones slide along it. Balls turn about all axes; planar
            bones slide along the X and Y axes of the bone and turn about its Z axis; floating bones move freely. These
            three only move if the physics moves the joints.
        axis: 0, 1 or 2: the X, Y or Z axis of the bone.
        free: axes about which the bone may rotate according to the file.
        low: smallest value of the joint, rad or m.
        high: largest value.
        value: initial value.
        leader: index of the bone whose joint this one follows, as ``factor * value + offset``; -1 for none.
        starts_apart: whether a joint that follows another starts at its own value, and is then drawn to the other one.
        dynamics: friction, limits and motor of the joint if the physics moves it; None for the defaults.
    """

    name: str
    parent: int
    position: tuple[float, float, float]
    rotation: Rotation9
    length: float
    kind: JointKind = JointKind.FIXED
    axis: int = 1
    free: tuple[bool, bool, bool] = (False, False, False)
    low: float = 0.0
    high: float = 0.0
    value: float = 0.0
    leader: int = -1
    factor: float = 1.0
    offset: float = 0.0
    dynamics: JointDynamics | None = None
    starts_apart: bool = False


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


Floats = tuple[float, ...]


class ConstraintKind(StrEnum):
    """What a constraint keeps equal; the words of MJCF."""

    CONNECT = "connect"
    WELD = "weld"
    JOINT = "joint"


@dataclass(frozen=True, slots=True)
class Constraint:
    """A constraint.

    Attributes:
        one, other: names of two links or joints; the second one of joints may be empty.
        data: ``connect``: the point in the frame of the first link, m. ``weld``: a point in the frame of the second
            link and the same point in that of the first one, m; the quaternion of the second link in the first one; the
            torque scale. Otherwise five coefficients of a polynomial, of the differences from the initial values.
        solver: ``solref`` (2) and ``solimp`` (5); None for as stiff as the step of the engine allows.
        is_active: whether it holds from the start.
    """

    kind: ConstraintKind
    one: str
    other: str
    data: Floats
    solver: Floats | None = None
    is_active: bool = True


@dataclass(frozen=True, slots=True)
class Couplings:
    """All couplings of an armature."""

    constraints: tuple[Constraint, ...] = ()


#: property of an armature: whether the physics moves its joints
DYNAMIC = "Dynamic"
#: property of an armature: the control mode of its motors
CONTROL = "Control"


class Control(StrEnum):
    """The control mode of the motor of a joint.

    A motor that controls a position or a velocity exerts the necessary effort (N m or N), up to its limit. A motor
    for efforts exerts the commanded effort; without a command, the joint moves freely.
    """

    POSITION = "position"
    VELOCITY = "velocity"
    EFFORT = "effort"


@dataclass(frozen=True, slots=True)
class JointDynamics:
    """The dynamics of a joint.

    Units are those of revolute joints. For prismatic joints, rad is replaced by m, and N m by N.

    Attributes:
        damping: N m s/rad.
        friction: dry friction, N m.
        inertia: inertia of the rotor of the motor at the joint, kg m^2.
        stiffness: stiffness of a spring, N m/rad.
        rest: joint value at which the spring is at rest, rad.
        effort: largest effort of the motor, N m.
        speed: largest speed, rad/s.
        limited: whether the joint stops at the limits of its bone.
        control: quantity that the motor controls, or None if the file does not declare it: a position.
        gain: gain of the motor: N m/rad for a position, N m s/rad for a velocity; None for a value derived from the
            masses.
        slowing: damping of a motor that controls a position, N m s/rad; None for a value derived from the gain.
    """

    damping: float = 0.0
    friction: float = 0.0
    inertia: float = 0.0
    stiffness: float = 0.0
    rest: float = 0.0
    effort: float = math.inf
    speed: float = math.inf
    limited: bool = True
    control: Control | None = None
    gain: float | None = None
    slowing: float | None = None


@dataclass(frozen=True, slots=True)
class Inertial:
    """The mass of a link.

    Attributes:
        mass: kg.
        centre: centre of mass, m, in the frame of the link.
        inertia: 9 numbers, row by row, about the centre of mass in the axes of the link, kg m^2.
    """

    mass: float
    centre: tuple[float, float, float]
    inertia: tuple[float, float, float, float, float, float, float, float, float]


@dataclass(frozen=True, slots=True)
class Articulation:
    """The joints of an armature, or of the robot to which it belongs, as declared in the file.

    Attributes:
        mass: mass of all links together, kg; 0 if the file has no masses.
        self_collision: whether links collide with each other. Links that are connected by a joint never collide.
        apart: pairs of links that do not collide, by their names in the file.
        couplings: constraints.
        control: joint to the quantity that its motor controls, if it differs from the file.
        gains: joint, stiffness (N m/rad) and damping (N m s/rad) of its motor, if they differ from the file.
        description: of a robot: its URDF file, expanded, with the paths of meshes as URLs; empty for other formats.
        meshes: of the description: URLs with their files on this machine; empty if the scene comes from a recording.
        model: the MJCF model of the robot, from which the engine takes its bodies; None for other formats.
    """

    mass: float = 0.0
    self_collision: bool = False
    apart: tuple[tuple[str, str], ...] = ()
    control: tuple[tuple[str, Control], ...] = ()
    gains: tuple[tuple[str, float | None, float | None], ...] = ()
    couplings: Couplings = field(default_factory=Couplings)
    description: str = ""
    meshes: tuple[tuple[str, str], ...] = ()
    model: MjcfModel | None = None
