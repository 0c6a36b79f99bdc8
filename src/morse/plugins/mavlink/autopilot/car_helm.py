"""Steers a car, which turns only while it drives, along arcs."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, cast

from morse.plugins.mavlink.autopilot.helms import Helm, TwistHelm

if TYPE_CHECKING:
    from morse.core.kinds import BoundKind
    from morse.mathutils.rotations import Triple
    from morse.plugins.mavlink.autopilot.helms import Motion, Speeds
    from morse.plugins.mavlink.axes import Place
    from morse.plugins.mavlink.vehicle import MavlinkStream

#: m: the car stops this far from its goal; gain of distances, 1/s
_TOLERANCE, _APPROACH = 0.25, 0.8
#: a goal that arcs cannot reach is left behind until it is this share of the turning radius outside, or ahead
_OUTSIDE, _AHEAD, _BEHIND = 1.3, math.radians(20.0), math.radians(120.0)
#: m/s, while it backs; for setpoints without a limit
_BACKWARD, _LEVEL = 1.0, 5.0
#: gain of headings, 1/s
_TURN = 1.5


class CarHelm(TwistHelm):
    """Speeds and curvatures of a car with `MotionVWAckermann`.

    Towards a goal it follows the arc that leads there (pure pursuit). It backs away from a goal inside its smallest
    circle, and backs to one close behind it.
    """

    #: angle of the direction in which the car drives from the X axis of the robot, rad
    ahead = 0.0

    def __init__(self, stream: MavlinkStream, bound: BoundKind, place: Place) -> None:
        Helm.__init__(self, stream, bound, place)
        self.is_sideways = self.is_vertical = False
        self.car = cast("Any", stream.component_instance)
        self.radius: float = self.car.turning_radius
        self._backs = False

    def forget(self) -> None:
        """See `Helm.forget`."""
        super().forget()
        self._backs = False

    def goto(self, goal: Triple, yaw: float | None, speeds: Speeds, now: Motion) -> None:
        """See `Helm.goto`."""
        x, y = goal[0] - now.position[0], goal[1] - now.position[1]
        distance, error = math.hypot(x, y), math.remainder(math.atan2(y, x) - now.yaw - self.ahead, math.tau)
        if distance < _TOLERANCE:
            self._backs = False
            self.drive(0.0, 0.0, now)
            return
        level = min(_APPROACH * distance, speeds.level, _LEVEL if math.isinf(speeds.level) else math.inf)
        if abs(error) > _BEHIND and distance < self.radius:
            behind = math.remainder(error - math.pi, math.tau)
            self.drive(-min(level, _BACKWARD), -self._bent(2.0 * math.sin(behind) / distance), now)
            return
        # the goal from the centre of the smallest circle on its side
        off = math.hypot(distance * math.cos(error), distance * abs(math.sin(error)) - self.radius)
        if self._backs:
            self._backs = abs(error) > _AHEAD and off < _OUTSIDE * self.radius
        else:
            self._backs = abs(error) > _AHEAD and off < self.radius
        if self._backs:
            self.drive(-min(speeds.level, _BACKWARD), -math.copysign(1.0 / self.radius, error), now)
            return
        bend = 2.0 * math.sin(error) / distance if abs(error) < 0.5 * math.pi else math.copysign(math.inf, error)
        self.drive(level * max(0.4, math.cos(error)), self._bent(bend), now)

    def _bent(self, curvature: float) -> float:
        return max(-1.0 / self.radius, min(curvature, 1.0 / self.radius))

    def go(self, velocity: Triple, yaw: float | None, rate: float, now: Motion) -> None:
        """See `Helm.go`."""
        x, y, _ = velocity
        speed = math.hypot(x, y)
        if speed < 1e-6:
            self.drive(0.0, 0.0, now)
            return
        error = math.remainder(math.atan2(y, x) - now.yaw - self.ahead, math.tau)
        self.drive(speed, self._bent(_TURN * error / speed), now)

    def body(self, velocity: Triple, rate: float, now: Motion) -> None:
        """See `TwistHelm.body`."""
        speed = velocity[0]
        self.drive(speed, self._bent(rate / speed) if abs(speed) > 1e-6 else 0.0, now)

    def drive(self, speed: float, curvature: float, now: Motion) -> None:
        """Drive forward, m/s, with a curvature to the left, 1/m."""
        self.send(linear=(speed, 0.0, 0.0), angular=(0.0, 0.0, speed * curvature))


class ForceHelm(CarHelm):
    """The same by the steering, the engine and the brakes of `SteerForce`."""

    #: gain of speeds, 1/s, and largest acceleration, m/s^2
    _gain, _most = 2.0, 3.0

    def __init__(self, stream: MavlinkStream, bound: BoundKind, place: Place) -> None:
        super().__init__(stream, bound, place)
        self.ahead = self.car.ahead

    def drive(self, speed: float, curvature: float, now: Motion) -> None:
        """See `CarHelm.drive`."""
        slots: dict[str, object] = {"steer": self.car.angle_of(curvature), "force": 0.0, "brake": 0.0}
        if speed == 0.0:
            slots["brake"] = self.car.brake_for(self._most)
        else:
            heading = now.yaw + self.ahead
            present = now.velocity[0] * math.cos(heading) + now.velocity[1] * math.sin(heading)
            slots["force"] = self.car.force_for(max(-self._most, min(self._gain * (speed - present), self._most)))
        self.send(**slots)
