"""Robots that are steered like cars."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from morse.core.declarations import add_property, add_state
from morse.core.parts.ackermann_steering import AckermannSteering
from morse.core.robot import Robot
from morse.helpers.controller import PIDController

if TYPE_CHECKING:
    from collections.abc import Sequence

    from morse.core.world import Body


class PhysicsAckermannRobot(Robot):
    """A robot with steered front wheels and driven rear wheels, controlled by speed and yaw rate.

    A PID controller (see `morse.helpers.controller`) turns the error of the speed into an acceleration. A second PID
    controller turns the error of the yaw rate into an angular acceleration. The front wheels are turned so that all
    wheels roll around one point. If the steering angle reaches its limit, or the robot stands still, the robot turns
    more slowly than commanded.
    """

    add_property(
        "_max_steering_angle",
        45.0,
        "max_steering_angle",
        "double",
        "Largest steering angle of the front wheels",
        unit="deg",
        low=0.0,
    )
    add_property("_vel_p_gain", 1.0, "velocity_p_gain", "double", "Proportional gain of the speed")
    add_property("_vel_d_gain", 1.0, "velocity_d_gain", "double", "Derivative gain of the speed")
    add_property("_vel_i_gain", 1.0, "velocity_i_gain", "double", "Integral gain of the speed")
    add_property(
        "_vel_limits", 1.0, "velocity_integral_limits", "double", "Largest sum of errors of the speed", low=0.0
    )
    add_property("_ang_p_gain", 1.0, "angular_velocity_p_gain", "double", "Proportional gain of the yaw rate")
    add_property("_ang_d_gain", 1.0, "angular_velocity_d_gain", "double", "Derivative gain of the yaw rate")
    add_property("_ang_i_gain", 1.0, "angular_velocity_i_gain", "double", "Integral gain of the yaw rate")
    add_property(
        "_ang_limits",
        1.0,
        "angular_velocity_integral_limits",
        "double",
        "Largest sum of errors of the yaw rate",
        low=0.0,
    )

    add_state("_speed_control", PIDController, "Controller of the speed: sum of errors, last error")
    add_state("_rate_control", PIDController, "Controller of the yaw rate: sum of errors, last error")

    _max_steering_angle: float
    _vel_p_gain: float
    _vel_d_gain: float
    _vel_i_gain: float
    _vel_limits: float
    _ang_p_gain: float
    _ang_d_gain: float
    _ang_i_gain: float
    _ang_limits: float

    def __init__(self, obj: Body, parent: Robot | None = None) -> None:
        super().__init__(obj, parent)
        #: axles of the robot (`morse.core.parts.ackermann_steering.AckermannSteering`)
        self.steering = AckermannSteering(self)
        self._speed_control = PIDController(self._vel_p_gain, self._vel_d_gain, self._vel_i_gain, self._vel_limits)
        self._rate_control = PIDController(self._ang_p_gain, self._ang_d_gain, self._ang_i_gain, self._ang_limits)

    @property
    def max_steering_angle(self) -> float:
        """Largest steering angle of the front wheels, rad."""
        return math.radians(self._max_steering_angle)

    def apply_vw_wheels(self, vx: float, vw: float) -> None:
        """Drive towards a speed of ``vx`` m/s and a yaw rate of ``vw`` rad/s during the next tick."""
        steering = self.steering
        speed, rate = steering.speed(), steering.yaw_rate()
        self._speed_control.setpoint, self._rate_control.setpoint = vx, vw
        dt = 1.0 / self.clock.frequency
        speed += self._speed_control.update(speed) * dt
        rate += self._rate_control.update(rate) * dt
        most = self.max_steering_angle
        steering.drive(speed, min(max(steering.angle_for(speed, rate), -most), most))

    def apply_speed(self, kind: str, linear_speed: Sequence[float], angular_speed: Sequence[float]) -> None:
        """Drive with the wheels; only the forward speed and the yaw rate are used."""
        self.apply_vw_wheels(linear_speed[0], angular_speed[2])
