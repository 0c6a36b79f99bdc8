"""The bones of an armature: a tree of joints."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from morse.mathutils.rotations import Rotation9
    from morse.scene.articulation import JointDynamics


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
