"""Kinematics of a car: the rear wheels roll without slipping sideways, the front wheels are steered."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

    from morse.core.robot import Robot

#: largest steering angle; beyond it a wheel is almost perpendicular to the direction of travel
_MOST = math.radians(80.0)
_FINE = 1e-4


class AckermannSteering:
    """The axles of a robot: parts of its model whose names contain ``wheel``.

    A car is longer than it is wide. Therefore, the robot drives along its X axis, or along its Y axis if the wheels are
    farther apart along Y.

    Args:
        robot: the robot.

    Attributes:
        wheelbase: distance between the axles, m.
        track: distance between the left and the right wheels, m.
        along_y: whether the robot drives along Y.

    Raises:
        ValueError: the robot has no front and rear wheels.
    """

    def __init__(self, robot: Robot) -> None:
        self._body = body = robot.bge_object
        wheels = []
        for part in body.childrenRecursive:
            name = part.node.plain_name.lower()
            if "wheel" in name and "caster" not in name:
                position = part.world_pose()[0]
                here, frame = body.world_pose()
                offset = [a - b for a, b in zip(position, here, strict=True)]
                x, y = (frame[i] * offset[0] + frame[i + 3] * offset[1] + frame[i + 6] * offset[2] for i in (0, 1))
                wheels.append((x, y, part))
        spread_x, spread_y = _spread([x for x, _, _ in wheels]), _spread([y for _, y, _ in wheels])
        self.along_y = spread_y > spread_x
        if self.along_y:
            wheels = [(y, -x, part) for x, y, part in wheels]
        middle = 0.5 * (max(w[0] for w in wheels) + min(w[0] for w in wheels)) if wheels else 0.0
        front = [wheel for wheel in wheels if wheel[0] > middle]
        rear = [wheel for wheel in wheels if wheel[0] < middle]
        if not front or not rear:
            raise ValueError(f"'{body.name}' has no front and rear wheels: parts of its model named '...wheel...'")
        self._rear = sum(x for x, _, _ in rear) / len(rear)
        self.wheelbase: float = sum(x for x, _, _ in front) / len(front) - self._rear
        self.track: float = _spread([y for _, y, _ in wheels])
        #: lateral offset (to the left), wheel, and orientation of the wheel at steering angle 0
        self._front = [(y, part, part.local_pose()[1]) for _, y, part in front]

    def speed(self) -> float:
        """Speed forward, m/s."""
        v, r = self._body.velocity()[0], self._body.world_pose()[1]
        first = 1 if self.along_y else 0
        return float(r[first] * v[0] + r[first + 3] * v[1] + r[first + 6] * v[2])

    def yaw_rate(self) -> float:
        """Yaw rate, rad/s, positive to the left."""
        w, r = self._body.velocity()[1], self._body.world_pose()[1]
        return float(r[2] * w[0] + r[5] * w[1] + r[8] * w[2])

    def angle_for(self, speed: float, rate: float) -> float:
        """Steering angle, rad, for a speed of ``speed`` m/s and a yaw rate of ``rate`` rad/s."""
        return math.atan2(rate * self.wheelbase, speed) if speed > 0.0 else -math.atan2(rate * self.wheelbase, -speed)

    def drive(self, speed: float, angle: float) -> None:
        """Drive during the next tick.

        Args:
            speed: speed of the middle of the rear axle, m/s.
            angle: steering angle of a wheel in the middle of the front axle, rad, positive to the left.
        """
        angle = min(max(angle, -_MOST), _MOST)
        rate = speed * math.tan(angle) / self.wheelbase
        aside = -self._rear * rate
        linear = (-aside, speed, 0.0) if self.along_y else (speed, aside, 0.0)
        self._body.drive(linear, (0.0, 0.0, rate), ground=True)
        self._turn_wheels(math.tan(angle))

    def _turn_wheels(self, tangent: float) -> None:
        for left, wheel, rest in self._front:
            # all wheels turn about one point on the line of the rear axle
            own = math.atan2(self.wheelbase * tangent, self.wheelbase - left * tangent)
            position, now = wheel.local_pose()
            rotation = _turned(own, rest)
            if abs(rotation[0] - now[0]) + abs(rotation[3] - now[3]) < _FINE:
                return
            wheel.set_local_pose(position, rotation)


def _spread(values: Sequence[float]) -> float:
    return max(values) - min(values) if values else 0.0


def _turned(angle: float, r: Sequence[float]) -> tuple[float, ...]:
    """A rotation, 9 numbers, followed by a rotation about Z."""
    c, s = math.cos(angle), math.sin(angle)
    x, y, z, u, v, w, *last = r
    return (c * x - s * u, c * y - s * v, c * z - s * w, s * x + c * u, s * y + c * v, s * z + c * w, *last)
