"""Optional limits of the speeds that an actuator applies to a robot."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from morse.core.actuator import Actuator
from morse.core.services import service
from morse.helpers.components import add_property, add_state

if TYPE_CHECKING:
    from collections.abc import Sequence

    from morse.core.robot import Robot
    from morse.core.world import Body


Vector = list[float]


class Ramp:
    """The speed of one moving part, along one axis or several axes.

    A limit holds for the length of the vector. The acceleration is increased and decreased at the rate of the jerk, so
    that it is zero when the commanded speed is reached.

    Args:
        axes: number of components of the speed.

    Attributes:
        speed: speed in the last tick, m/s or rad/s.
        acceleration: acceleration in the last tick, m/s² or rad/s².
    """

    def __init__(self, axes: int = 1) -> None:
        self.speed: Vector = [0.0] * axes
        self.acceleration: Vector = [0.0] * axes

    def follow(self, target: Sequence[float], dt: float, limits: Sequence[float]) -> Vector:
        """Return the speed after a tick.

        Args:
            target: the commanded speed.
            dt: length of the tick, s.
            limits: largest speed, acceleration and jerk; 0 for no limit.
        """
        most_speed, most_acceleration, most_jerk = limits
        goal = _shortened(target, most_speed)
        differences = [there - here for there, here in zip(goal, self.speed, strict=True)]
        distance = math.hypot(*differences)
        size = distance / dt
        if most_jerk:
            # the largest acceleration that can still be reduced to 0, by one step of the jerk per tick, before the
            # commanded speed is reached: the speed changes by size * (1 + size / step) / 2 * dt in these ticks
            step = most_jerk * dt
            size = min(size, (math.sqrt(step * step + 8.0 * step * distance / dt) - step) / 2.0)
        if most_acceleration:
            size = min(size, most_acceleration)
        change = [part * size / distance if distance else 0.0 for part in differences]
        if most_jerk:
            turn = _shortened([a - b for a, b in zip(change, self.acceleration, strict=True)], most_jerk * dt)
            change = [a + b for a, b in zip(self.acceleration, turn, strict=True)]
        self.acceleration = change
        self.speed = _shortened([v + a * dt for v, a in zip(self.speed, change, strict=True)], most_speed)
        return self.speed


def _shortened(vector: Sequence[float], most: float) -> Vector:
    """Limit the length of a vector; a limit of 0 means no limit."""
    length = math.hypot(*vector)
    if not most or length <= most:
        return list(vector)
    return [part * (most / length) for part in vector]


class LimitedMotion(Actuator):
    """Follows the commanded speeds within limits of speed, acceleration and jerk; 0 means no limit.

    Attributes:
        linear_axes: components of the linear speed.
    """

    commands_speed = True

    add_property("_max_v", 0.0, "MaxSpeed", "float", "Largest linear speed; 0: no limit", unit="m/s", low=0.0, high=1e4)
    add_property(
        "_max_a",
        0.0,
        "MaxAcceleration",
        "float",
        "Limit of the linear acceleration; 0: no limit",
        unit="m/s²",
        low=0.0,
        high=1e6,
    )
    add_property(
        "_max_j", 0.0, "MaxJerk", "float", "Limit of the linear jerk; 0: no limit", unit="m/s³", low=0.0, high=1e8
    )
    add_property(
        "_max_w", 0.0, "MaxAngularSpeed", "float", "Largest turning rate; 0: no limit", unit="rad/s", low=0.0, high=1e4
    )
    add_property(
        "_max_dw",
        0.0,
        "MaxAngularAcceleration",
        "float",
        "Limit of the angular acceleration; 0: no limit",
        unit="rad/s²",
        low=0.0,
        high=1e6,
    )
    add_property(
        "_max_ddw",
        0.0,
        "MaxAngularJerk",
        "float",
        "Limit of the angular jerk; 0: no limit",
        unit="rad/s³",
        low=0.0,
        high=1e8,
    )

    add_state("_angular", Ramp, "Angular velocity under the limit of acceleration")
    add_state("_linear", Ramp, "Linear velocity under the limit of acceleration")

    linear_axes = 1

    _max_v: float
    _max_a: float
    _max_j: float
    _max_w: float
    _max_dw: float
    _max_ddw: float

    def __init__(self, obj: Body, parent: Robot | None = None) -> None:
        super().__init__(obj, parent)
        self._linear = Ramp(self.linear_axes)
        self._angular = Ramp()

    @service
    def set_property(self, name: str, value: object) -> None:
        """Change a property while the simulation runs.

        If there was no limit before, the speeds continue from the command.
        """
        were = self.is_limited()
        super().set_property(name, value)
        if self.is_limited() and not were:
            linear, angular = self.commanded()
            self._linear.speed, self._angular.speed = list(linear), [angular]

    def is_limited(self) -> bool:
        """Whether there is any limit."""
        return any((self._max_v, self._max_a, self._max_j, self._max_w, self._max_dw, self._max_ddw))

    def commanded(self) -> tuple[Sequence[float], float]:
        """Return the linear speed, m/s, and turning rate, rad/s, of the last command. Override it."""
        raise NotImplementedError

    def speeds(self) -> tuple[Sequence[float], float]:
        """Return the linear speed, m/s, and turning rate, rad/s, of this tick."""
        linear, angular = self.commanded()
        if not self.is_limited():
            return linear, angular
        dt = 1.0 / self.frequency
        return (
            self._linear.follow(linear, dt, (self._max_v, self._max_a, self._max_j)),
            self._angular.follow([angular], dt, (self._max_w, self._max_dw, self._max_ddw))[0],
        )
