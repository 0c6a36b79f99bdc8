"""Drives a car: two wheels steer, two wheels drive."""

from __future__ import annotations

import math
from statistics import fmean
from typing import TYPE_CHECKING

from morse.actuators.speed_command import SpeedCommand
from morse.helpers.components import add_property
from morse.helpers.joint_motors import WHEEL_LENGTH, JointMotors, joint_names
from morse.scene import Control
from morse.scene.joint_wheels import joint_wheels

if TYPE_CHECKING:
    from collections.abc import Sequence

    from morse.core.robot import Robot
    from morse.core.world import Body


class MotionVWAckermann(SpeedCommand):
    """Steers and turns the wheels of a car so that it drives and turns at the commanded speeds.

    The wheels are joints of the robot. The middle of the axle that does not steer follows a circle of the radius
    R = v / w. The steered wheels point along their own circles about the same centre: tan(angle) = L / (R -+ s / 2),
    with the wheel base L and the distance s between the steering joints (Ackermann steering). L is negative if the
    steered wheels are behind the other axle, as those of forklifts: to turn to the left, they point to the right. Each
    driven wheel turns at the speed of its place on the circle. A car that stands cannot turn.
    """

    _name = "Ackermann steering"
    _short_desc = "Motion controller using linear and angular speeds, by driven and steered wheels"

    add_property("_left", "", "LeftWheels", "string", "Driven joints on the left, separated by commas")
    add_property("_right", "", "RightWheels", "string", "Driven joints on the right")
    add_property("_left_steering", "", "LeftSteering", "string", "Joint that steers the wheel on the left")
    add_property("_right_steering", "", "RightSteering", "string", "Joint that steers the wheel on the right")
    add_property("_radius", 0.0, "WheelRadius", "float", "Radius of the wheels; 0: of their shapes", **WHEEL_LENGTH)
    add_property(
        "_base", 0.0, "WheelBase", "float", "Distance between the axles; 0: between their joints", **WHEEL_LENGTH
    )
    add_property(
        "_separation",
        0.0,
        "WheelSeparation",
        "float",
        "Distance between left and right wheels; 0: between the joints that steer them",
        **WHEEL_LENGTH,
    )
    add_property("_limit", 0.5, "SteeringLimit", "float", "Largest angle of a wheel", unit="rad", low=1e-3, high=1.5)

    _left: str
    _right: str
    _left_steering: str
    _right_steering: str
    _radius: float
    _base: float
    _separation: float
    _limit: float

    def __init__(self, obj: Body, parent: Robot | None = None) -> None:
        super().__init__(obj, parent)
        body = self.robot_parent.bge_object
        left, right = joint_names(self._left), joint_names(self._right)
        steering = joint_names(self._left_steering) + joint_names(self._right_steering)
        self._wheels: JointMotors | None = None
        self._steering: JointMotors | None = None
        if left and right and len(steering) == 2:
            self._wheels = JointMotors.of_wheels(body, left + right, joint_wheels(body.node))
            self._steering = JointMotors(body, steering, Control.POSITION)
            self._measure(body, [*left, *right], steering)
        else:
            self.context.complaints.warn(
                f"{self.name()}: no joints",
                f"{self.name()} moves nothing, it needs the joints of the wheels: properties(LeftWheels='rear_left', "
                "RightWheels='rear_right', LeftSteering='left_steering', RightSteering='right_steering')",
            )
        self._sides = (-1.0,) * len(left) + (1.0,) * len(right)

    def _measure(self, body: Body, wheels: Sequence[str], steering: Sequence[str]) -> None:
        """Measure on the model what the script does not set."""
        joints = {wheel.joint: wheel for wheel in joint_wheels(body.node)}
        angles, steering_angles = [joints[name] for name in wheels], [joints[name] for name in steering]
        self._radius = self._radius or fmean(wheel.radius for wheel in angles)
        ahead = fmean(one.x for one in steering_angles) - fmean(one.x for one in angles)
        self._base = math.copysign(self._base, ahead) if self._base else ahead
        self._separation = self._separation or abs(steering_angles[0].y - steering_angles[1].y)
        if not (self._radius and self._base and self._separation):
            raise ValueError(
                f"{self.name()}: the wheels {', '.join(wheels)} have no shapes to be measured: "
                "properties(WheelRadius=0.3, WheelBase=2.5, WheelSeparation=1.5)"
            )

    def turning_speed(self, speed: float, angle: float) -> float:
        """The angular speed of a car, rad/s.

        Args:
            speed: of the middle of the axle that does not steer, m/s.
            angle: of a wheel in the middle between those that steer, rad, positive for turns to the left.
        """
        return speed * math.tan(min(max(angle, -self._limit), self._limit)) / abs(self._base)

    @property
    def turning_radius(self) -> float:
        """Radius of the smallest circle of the middle of the axle that does not steer, m."""
        return abs(self._base) / math.tan(self._limit)

    def default_action(self) -> None:
        """Steer and turn the wheels."""
        (v,), w = self.speeds()
        if self._wheels is None or self._steering is None:
            return
        half = 0.5 * self._separation
        # curvature, 1/m, up to that of the largest angle
        most = math.tan(self._limit) / abs(self._base)
        curvature = min(max(w / v, -most), most) if abs(v) > 1e-6 else 0.0
        angles = [math.atan(self._base * curvature / (1.0 + side * half * curvature)) for side in (-1.0, 1.0)]
        self._steering.tell([min(max(angle, -self._limit), self._limit) for angle in angles])
        self._wheels.tell([v * (1.0 + side * half * curvature) / self._radius for side in self._sides])
