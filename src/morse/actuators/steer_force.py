"""Drives a car by steering, engine force and brakes."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from morse.core.actuator import Actuator
from morse.core.limits import ANGLE, FORCE
from morse.core.wheeled_robot import AckermannSteering, PhysicsAckermannRobot
from morse.helpers.components import add_data, add_kind

if TYPE_CHECKING:
    from morse.core.robot import Robot
    from morse.core.world import Body

#: share of the force at each of the four wheels
_ENGINE = 0.4
#: largest steering angle of usual cars, rad, where the robot has none
_USUAL = math.radians(35.0)
#: shares of the brake force at both front wheels and at both rear wheels
_BRAKE = 2 * 0.1 + 2 * 1.3
#: the engine of 1.4: largest deceleration by the brakes, because the tyres slid, m/s^2; and the mass that the engine
#: force moves, relative to that of the body
_GRIP_OF_1_4, _INERTIA_OF_1_4 = 4.0, 2.0


class SteerForce(Actuator):
    """Steers the front wheels of a car, drives its four wheels, and brakes them.

    Each wheel is driven by 0.4 times the force. As in MORSE 1.4, a negative force drives forward. Each front wheel is
    braked by 0.1 times, each rear wheel by 1.3 times the brake force, until the car stands still. The car turns about a
    point on the line of its rear axle: its yaw rate is v tan(steer) / wheelbase. Without force it keeps rolling.

    With ``env.use_physics_of_1_4()`` the force accelerates twice the mass, the car has rolling friction, and the brake
    is an impulse, N s, of each tick, by which the car loses at most 4 m/s each second.
    """

    _name = "Steer, force, brake"
    _short_desc = "Motion controller using steering, engine force and brakes of a car"
    _source = "Ackermann steering: single-track model without slip"

    add_data("steer", 0.0, "float", "Angle of the front wheels, positive to the left", frame="robot", **ANGLE)
    add_data("force", 0.0, "float", "Force of the engine; negative drives forward", frame="robot", **FORCE)
    add_data("brake", 0.0, "float", "Force of the brakes", unit="N", low=0.0, high=1e6)
    add_kind("general")

    def __init__(self, obj: Body, parent: Robot | None = None) -> None:
        super().__init__(obj, parent)
        robot = self.robot_parent
        self._most = math.inf
        if isinstance(robot, PhysicsAckermannRobot):
            self._steering, self._most = robot.steering, robot.max_steering_angle
            return
        try:
            self._steering = AckermannSteering(robot)
        except ValueError as error:
            raise ValueError(f"{error}; SteerForce drives cars such as Hummer") from None

    @property
    def turning_radius(self) -> float:
        """Radius of the smallest circle of the middle of the rear axle, m."""
        return self._steering.wheelbase / math.tan(min(self._most, _USUAL))

    @property
    def ahead(self) -> float:
        """Angle of the direction in which the car drives from the X axis of the robot, rad."""
        return 0.5 * math.pi if self._steering.along_y else 0.0

    def angle_of(self, curvature: float) -> float:
        """The angle of the front wheels, rad, for a curvature to the left, 1/m."""
        return math.atan(self._steering.wheelbase * curvature)

    def force_for(self, acceleration: float) -> float:
        """The force of the engine, N, for an acceleration forward, m/s^2."""
        return -acceleration * self.robot_parent.bge_object.mass / (4.0 * _ENGINE)

    def brake_for(self, deceleration: float) -> float:
        """The force of the brakes, N, for a deceleration, m/s^2."""
        return min(deceleration * self.robot_parent.bge_object.mass / _BRAKE, 1e6)

    def default_action(self) -> None:
        """Drive."""
        data = self.local_data
        mass = self.robot_parent.bge_object.mass
        if not mass:
            return
        dt = 1.0 / self.clock.frequency
        braking = _BRAKE * data["brake"] / mass * dt
        if self.context.world.physics_of_1_4:
            mass *= _INERTIA_OF_1_4
            # the brake was an impulse of each step
            braking = min(braking / dt, _GRIP_OF_1_4 * dt)
        speed = self._steering.speed() - 4.0 * _ENGINE * data["force"] / mass * dt
        speed = math.copysign(max(abs(speed) - braking, 0.0), speed)
        self._steering.drive(speed, min(max(data["steer"], -self._most), self._most))
