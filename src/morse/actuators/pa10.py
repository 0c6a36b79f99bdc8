"""Moves the segments of a PA-10 arm."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from morse.core.actuator import Actuator
from morse.core.classes.builder_defaults import BuilderDefaults
from morse.core.limits import ANGLE, Angle
from morse.core.services import service
from morse.helpers.components import add_data, add_kind, add_property, add_state
from morse.mathutils.rotations import rotation_of
from morse.scene import Bone, JointKind

if TYPE_CHECKING:
    from morse.core.robot import Robot
    from morse.core.world import Body

_SEGMENTS = ("seg0", "seg1", "seg2", "seg3", "seg4", "seg5")
#: rotation axis of each segment
_AXES = "zyyzyz"
_IDENTITY = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)


class PA10(Actuator):
    """Rotates the six segments of the arm to their setpoints, all at the same speed.

    The first, fourth and sixth segments rotate about their Z axes, the others about their Y axes. Objects that are
    appended to the arm stay at its base; ``arm.append(obj, 'PA10-6')`` attaches an object to the last segment.
    """

    _name = "PA-10 Actuator"
    _short_desc = "Turns the segments of a Mitsubishi PA-10 arm"
    _builder = BuilderDefaults(model="pa_10")

    add_data("seg0", 0.0, "float", "First segment, about its Z axis", frame="joint", **ANGLE)
    add_data("seg1", 0.0, "float", "Second segment, about its Y axis", frame="joint", **ANGLE)
    add_data("seg2", 0.0, "float", "Third segment, about its Y axis", frame="joint", **ANGLE)
    add_data("seg3", 0.0, "float", "Fourth segment, about its Z axis", frame="joint", **ANGLE)
    add_data("seg4", 0.0, "float", "Fifth segment, about its Y axis", frame="joint", **ANGLE)
    add_data("seg5", 0.0, "float", "Sixth segment, about its Z axis", frame="joint", **ANGLE)
    add_kind("joints", names=_SEGMENTS, position=_SEGMENTS)
    add_property("_speed", 1.0, "Speed", "float", "Angular speed of each segment", unit="rad/s", low=0.0, high=1e4)
    add_property(
        "_tolerance",
        math.radians(5.0),
        "Tolerance",
        "float",
        "A segment starts to move if its error is larger; it then moves until the error is 0",
        unit="rad",
        low=0.0,
    )

    add_state("_angles", list, "Angles of the segments", unit="rad")
    add_state("_turning", list, "Which segments turn")

    _speed: float
    _tolerance: float

    def __init__(self, obj: Body, parent: Robot | None = None) -> None:
        super().__init__(obj, parent)
        parts = [_part(obj, f"PA10-{i + 1}") for i in range(6)]
        bones = [_joint(part, axis) for part, axis in zip(parts, _AXES, strict=True)]
        hanging = [(part, i, (0.0, 0.0, 0.0), _IDENTITY) for i, part in enumerate(parts)]
        self._linkage = self.context.world.linkage(obj, bones, hanging)
        self._angles = [0.0] * 6
        #: the moving segments
        self._turning = [False] * 6

    @property
    def joint_values(self) -> tuple[float, ...]:
        """The present angles of the segments, rad."""
        return tuple(self._angles)

    def default_action(self) -> None:
        """Rotate the segments by one tick."""
        step = self._speed / self.frequency
        moves = False
        for number, segment in enumerate(_SEGMENTS):
            angle = self._angles[number]
            off = float(self.local_data[segment]) - angle
            if abs(off) > self._tolerance:
                self._turning[number] = True
            if not self._turning[number]:
                continue
            if abs(off) <= step:
                self._turning[number] = False
                angle += off
            else:
                angle += math.copysign(step, off)
            self._angles[number] = angle
            moves = True
        if moves:
            self._linkage.move(self._angles)

    @service
    def set_rotation_array(
        self,
        seg0: Angle = 0.0,
        seg1: Angle = 0.0,
        seg2: Angle = 0.0,
        seg3: Angle = 0.0,
        seg4: Angle = 0.0,
        seg5: Angle = 0.0,
    ) -> None:
        """Set the setpoints of the segments; the service does not wait until they are reached.

        Args:
            seg0: radians.
            seg1: radians.
            seg2: radians.
            seg3: radians.
            seg4: radians.
            seg5: radians.
        """
        self.local_data.update(zip(_SEGMENTS, map(float, (seg0, seg1, seg2, seg3, seg4, seg5)), strict=True))


def _part(obj: Body, name: str) -> Body:
    for part in obj.childrenRecursive:
        if part.node.plain_name == name:
            return part
    raise ValueError(f"its model has no part '{name}': a PA-10 arm needs six, PA10-1 to PA10-6")


def _joint(part: Body, axis: str) -> Bone:
    """The joint between a segment and its parent."""
    (x, y, z), rotation = part.local_pose()
    return Bone(part.name, -1, (x, y, z), rotation_of(rotation), 0.0, JointKind.REVOLUTE, "xyz".index(axis))
