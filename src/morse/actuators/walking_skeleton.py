"""The skeleton of a person, which swings its legs and arms while the person walks."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, ClassVar

from morse.actuators.armature import Armature
from morse.core.declarations import add_state

if TYPE_CHECKING:
    from morse.core.robot import Robot
    from morse.core.world import Body

#: distance of two steps, m, and speed from which on the steps are full, m/s
_STRIDE, _BRISK = 1.3, 0.6
#: time in which the legs swing back when the person stops, s
_SETTLE = 0.3
#: angles of a full step, rad: hips, knees, arms
_HIP, _KNEE, _ARM = 0.45, 0.6, 0.35


class WalkingSkeleton(Armature):
    """An armature of a person. The gait is added to the joint values that commands and targets determine.

    The gait depends on the distance that the robot has covered, so the feet do not slide at any speed. It needs a model
    with the property ``gait``, whose bones turn forward for positive angles, and the property ``Animations`` of the
    robot.
    """

    # a limb has too few joints for any pose: its place precedes its orientation
    _lever: ClassVar[float] = 0.3

    add_state("_posture", list, "Joint values without the gait", unit="rad")
    add_state("_shown", list, "Joint values with the gait, of the last tick", unit="rad")
    add_state("_place", tuple | None, "Position at the last tick", unit="m")
    add_state("_phase", float, "Phase of the gait", unit="rad")
    add_state("_vigour", float, "How far the legs swing, from 0 to 1")

    def __init__(self, obj: Body, parent: Robot | None = None) -> None:
        super().__init__(obj, parent)
        #: joint values without the gait, and with the gait of the last tick
        self._posture = self._shown = list(self._values)
        self._place: tuple[float, float] | None = None
        self._phase = self._vigour = 0.0

    def default_action(self) -> None:
        """Move the joints by one tick, and swing the legs and arms."""
        # services may have set other values since the last tick
        if self._values == self._shown:
            self._values = self._posture
        super().default_action()
        self._posture = self._shown = self._values
        swing = self._swing()
        if swing:
            pairs = enumerate(zip(self.joints, self._posture, strict=True))
            self._move_to([self.chain.clamped(number, value + swing.get(name, 0.0)) for number, (name, value) in pairs])
            self._shown = self._values

    def _swing(self) -> dict[str, float]:
        """Return the angles of the gait, rad; none while the person stands."""
        robot = self.robot_parent
        if robot is None or not getattr(robot, "_animations", False) or "gait" not in self.bge_object.properties:
            return {}
        here = (robot.position_3d.x, robot.position_3d.y)
        before, self._place = self._place or here, here
        way = math.dist(before, here)
        self._phase = math.remainder(self._phase + 2.0 * math.pi * way / _STRIDE, 2.0 * math.pi)
        target = min(way * self.frequency / _BRISK, 1.0)
        step = 1.0 / (_SETTLE * self.frequency)
        self._vigour += min(max(target - self._vigour, -step), step)
        if self._vigour < 1e-9:
            self._vigour = 0.0
            return {}
        left_swing = self._vigour * math.sin(self._phase)
        lift = self._vigour * math.cos(self._phase)
        return {
            "upperleg01_L": _HIP * left_swing,
            "upperleg01_R": -_HIP * left_swing,
            "lowerleg01_L": -_KNEE * max(lift, 0.0),
            "lowerleg01_R": -_KNEE * max(-lift, 0.0),
            # the arms swing against the legs; the axes of the collar bones point outward
            "clavicle_L": _ARM * left_swing,
            "clavicle_R": _ARM * left_swing,
        }
