"""Robots that are driven by wheels."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from morse.core.declarations import add_property, add_state
from morse.core.robot import Robot
from morse.core.robot_parts import MovingPart
from morse.mathutils.rotations import rows_of

if TYPE_CHECKING:
    from collections.abc import Sequence

    from morse.core.world import Body, Wheel


__all__ = ["PhysicsAckermannRobot", "PhysicsDifferentialRobot", "drives_wheels"]


_JUMP = 0.1  # a larger change of the setpoint starts a new motion


class PIDController:
    """A discrete PID controller that is updated at a fixed rate; its gains are per update, not per second.

    Attributes:
        kp: gain of the error.
        kd: gain of the change of the error since the last update.
        ki: gain of the sum of the errors.
        limits_integrator: largest magnitude of the sum of the errors.
    """

    def __init__(self, kp: float = 1.0, kd: float = 1.0, ki: float = 1.0, limits_integrator: float = 10.0) -> None:
        if not limits_integrator >= 0.0:
            raise ValueError(f"PIDController: limits_integrator cannot be negative, given {limits_integrator!r}")
        self.kp = kp
        self.kd = kd
        self.ki = ki
        self.limits_integrator = limits_integrator
        self._setpoint = 0.0
        self._last_error = 0.0
        self._integral = 0.0

    @property
    def setpoint(self) -> float:
        """The setpoint. A change of more than 0.1 resets the past errors."""
        return self._setpoint

    @setpoint.setter
    def setpoint(self, value: float) -> None:
        if abs(value - self._setpoint) > _JUMP:
            self.reset()
        self._setpoint = value

    def reset(self) -> None:
        """Reset the past errors."""
        self._last_error = 0.0
        self._integral = 0.0

    def update(self, current: float) -> float:
        """Return the command for the present value, in the unit of the gains times the unit of the value."""
        error = self._setpoint - current
        change = error - self._last_error
        self._last_error = error
        limit = self.limits_integrator
        self._integral = min(max(self._integral + error, -limit), limit)
        return self.kp * error + self.kd * change + self.ki * self._integral


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


class PhysicsAckermannRobot(Robot):
    """A robot with steered front wheels and driven rear wheels, controlled by speed and yaw rate.

    A PID controller (see `morse.core.wheeled_robot`) turns the error of the speed into an acceleration. A second PID
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
        #: axles of the robot (`morse.core.wheeled_robot.AckermannSteering`)
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


_STANDSTILL = 1e-3


class PhysicsDifferentialRobot(Robot):
    """A robot with two driven wheels, or two rows of driven wheels, which turns by a difference of wheel speeds.

    Wheels are the parts of the model whose names contain ``wheel`` and that collide. The track and the radius are
    measured on the model; ``FixTurningSpeed`` replaces the track in the equations

        left  = (v - e/2 w) / R        right = (v + e/2 w) / R
    """

    add_property(
        "_fix_turning", 0.0, "FixTurningSpeed", "double", "Effective track in metres; 0 for the measured track"
    )
    add_property("_influence", 0.1, "Influence", "double", "Exists for scripts of 1.4; the engine does not use it")
    add_property("_wheel_friction", 0.8, "Friction", "double", "Exists for scripts of 1.4; see set_friction")
    add_property("_has_suspension", True, "HasSuspension", "bool", "Exists for scripts of 1.4; wheels are rigid")

    add_property(
        "_ride_height", 0.0, "RideHeight", "double", "Height of the body above its wheels, relative to the model, m"
    )

    _fix_turning: float

    def __init__(self, obj: Body, parent: Robot | None = None) -> None:
        super().__init__(obj, parent)
        self._wheels = obj.wheels()
        if not self._wheels:
            raise ValueError(
                f"'{obj.name}' has no wheels: a wheeled robot needs parts that collide and whose names contain 'wheel'"
            )
        sides = [wheel.offset_y for wheel in self._wheels]
        self._track: float = max(sides) - min(sides)
        self._radius: float = sum(wheel.radius for wheel in self._wheels) / len(self._wheels)

    @property
    def track(self) -> float:
        """Distance between the left and right wheels in the equations of the speed, m."""
        return self._fix_turning or self._track

    @property
    def wheel_radius(self) -> float:
        """Radius of the wheels, m."""
        return self._radius

    def get_wheels(self) -> list[Wheel]:
        """The driven wheels."""
        return list(self._wheels)

    def moving_parts(self) -> list[MovingPart]:
        """The wheels."""
        left = rows_of(self.bge_object.world_pose()[1])
        parts = []
        for wheel in self._wheels:
            wheel_rotation = rows_of(wheel.object.world_pose()[1])
            # its axle is the Y axis of the robot; because of the rotation of the wheel both have the same coordinates
            x, y, z = (sum(wheel_rotation[k][i] * left[k][1] for k in range(3)) for i in range(3))
            name = wheel.object.name.rpartition(".")[2]
            parts.append(MovingPart(name, wheel.object, None, (x, y, z), lambda wheel=wheel: wheel.angle))  # type: ignore[misc]
        return parts

    def apply_vw_wheels(self, vx: float, vw: float) -> None:
        """Turn the wheels so that the robot drives at ``vx`` m/s and turns at ``vw`` rad/s."""
        if abs(vx) < _STANDSTILL and abs(vw) < _STANDSTILL:
            vx = vw = 0.0
        half = 0.5 * self.track * vw
        for wheel in self._wheels:
            wheel.set_speed((vx - half if wheel.offset_y > 0.0 else vx + half) / self._radius)

    def apply_speed(self, kind: str, linear_speed: Sequence[float], angular_speed: Sequence[float]) -> None:
        """Drive with the wheels; only the forward speed and the yaw rate are used."""
        self.apply_vw_wheels(linear_speed[0], angular_speed[2])


def drives_wheels(robot: Robot) -> bool:
    """Whether a robot turns its wheels as `PhysicsDifferentialRobot` does, so that their speeds last."""
    return all(
        getattr(type(robot), name) is getattr(PhysicsDifferentialRobot, name) and name not in vars(robot)
        for name in ("apply_vw_wheels", "track", "wheel_radius")
    )
