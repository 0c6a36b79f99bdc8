"""Steer a vehicle by the actuator that its robot has: one that takes positions, velocities, or attitudes."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, NamedTuple

from morse.core.kinds.turning import quaternion_of

if TYPE_CHECKING:
    from morse.core.kinds import BoundKind
    from morse.mathutils.rotations import Rotation9, Triple
    from morse.plugins.mavlink.axes import Place
    from morse.plugins.mavlink.vehicle import MavlinkStream

#: m; the same as of MORSE 1.4
_TOLERANCE = 0.5
#: gains of positions and headings, 1/s; fastest turn, rad/s; heading error that is corrected on the spot, rad
_APPROACH, _TURN, _MOST_TURN, _ON_THE_SPOT = 0.8, 1.5, 1.0, math.radians(45.0)
#: acceleration of a rotorcraft per error of its velocity, 1/s
_FOLLOW, _GRAVITY = 1.6, 9.81
#: seconds of the velocity by which a moving goal is ahead of the vehicle at most
_LEAD = 1.6


class Motion(NamedTuple):
    """What a helm knows about the vehicle.

    Attributes:
        position: in the world, m.
        velocity: in the world, m/s.
        rotation: to the world.
        yaw: in the world, rad.
        dt: seconds since the last tick.
    """

    position: Triple
    velocity: Triple
    rotation: Rotation9
    yaw: float
    dt: float


class Speeds(NamedTuple):
    """Limits, m/s; infinite for setpoints, which go to the actuator as they are."""

    level: float = math.inf
    up: float = math.inf
    down: float = math.inf


class Helm(ABC):
    """Steers by one stream of an actuator.

    Args:
        stream: of the actuator.
        bound: its message kind.
        place: converts from the world to the axes of the messages.
    """

    #: whether this is the helm of an aircraft, whose rotors stop while it is not armed
    is_sideways = is_vertical = True

    def __init__(self, stream: MavlinkStream, bound: BoundKind, place: Place) -> None:
        self.stream, self._bound, self._place = stream, bound, place
        self._last: dict[str, object] = {}

    @abstractmethod
    def goto(self, goal: Triple, yaw: float | None, speeds: Speeds, now: Motion) -> None:
        """Go to a position in the world, m, with a yaw in the world, rad, or any; called in each tick."""

    @abstractmethod
    def go(self, velocity: Triple, yaw: float | None, rate: float, now: Motion) -> None:
        """Move with a velocity in the world, m/s, and a yaw, rad, or a yaw rate, rad/s; called in each tick."""

    def forget(self) -> None:
        """The vehicle was steered by something else."""
        self._last = {}

    def send(self, **slots: object) -> None:
        """Command the actuator, unless it has the same command already."""
        if slots != self._last:
            self._last = slots
            self.stream.receive(self._bound, slots)


class GoalHelm(Helm):
    """Positions: if the actuator has no speed limit of its own, its goal moves to the destination with that speed."""

    def __init__(self, stream: MavlinkStream, bound: BoundKind, place: Place) -> None:
        super().__init__(stream, bound, place)
        self._goal: Triple | None = None
        self._yaw: float | None = None

    def forget(self) -> None:
        """See `Helm.forget`."""
        super().forget()
        self._goal = self._yaw = None

    def goto(self, goal: Triple, yaw: float | None, speeds: Speeds, now: Motion) -> None:
        """See `Helm.goto`."""
        if not self._bound.has("speed") and math.isfinite(speeds.level):
            at = self._goal or now.position
            flat, climb = math.dist(at[:2], goal[:2]), goal[2] - at[2]
            seconds = max(flat / speeds.level, climb / speeds.up, -climb / speeds.down)
            share = 1.0 if seconds <= now.dt else now.dt / seconds
            goal = _between(at, goal, share)
        self._goal = goal
        self._command(goal, yaw, speeds.level)

    def go(self, velocity: Triple, yaw: float | None, rate: float, now: Motion) -> None:
        """See `Helm.go`."""
        at, speed = self._goal or now.position, math.hypot(*velocity)
        ahead: Triple = tuple(a + v * now.dt for a, v in zip(at, velocity, strict=True))  # type: ignore[assignment]
        lead = math.dist(ahead, now.position)
        if lead > _LEAD * speed + _TOLERANCE:
            ahead = _between(now.position, ahead, (_LEAD * speed + _TOLERANCE) / lead)
        self._goal = ahead
        if yaw is None:
            yaw = math.remainder((now.yaw if self._yaw is None else self._yaw) + rate * now.dt, math.tau)
        self._command(ahead, yaw, speed)

    def _command(self, goal: Triple, yaw: float | None, speed: float) -> None:
        bound = self._bound
        slots: dict[str, object] = {}
        axes = self.stream.axes_of(bound.frame)
        slots["position"] = axes.vector(self._place.axes.vector(goal))
        if bound.has("orientation") and yaw is not None:
            self._yaw = yaw
            slots["orientation"] = quaternion_of(0.0, 0.0, axes.heading(self._place.heading(yaw)))
        if bound.has("tolerance"):
            slots["tolerance"] = _TOLERANCE
        if bound.has("speed") and math.isfinite(speed):
            slots["speed"] = speed
        self.send(**slots)


class TwistHelm(Helm):
    """Velocities, forward and turning; also sideways and upward if the actuator has them."""

    def __init__(self, stream: MavlinkStream, bound: BoundKind, place: Place) -> None:
        super().__init__(stream, bound, place)
        self.is_sideways = bound.scatter({"linear": (0.0, 1.0, 0.0)})[1] is None
        self.is_vertical = bound.scatter({"linear": (0.0, 0.0, 1.0)})[1] is None
        #: a rotorcraft follows a velocity within seconds: the bank angle depends on the acceleration as well
        gains = [float(getattr(stream.component_instance, name, 0.0)) for name in ("_h_pgain", "_h_dgain")]
        self._lead = _FOLLOW * (1.0 / _GRAVITY + gains[1]) / gains[0] if gains[0] > 0.0 else 1.0

    def goto(self, goal: Triple, yaw: float | None, speeds: Speeds, now: Motion) -> None:
        """See `Helm.goto`."""
        x, y, z = (a - b for a, b in zip(goal, now.position, strict=True))
        flat = math.hypot(x, y)
        level = min(_APPROACH * flat, speeds.level, 5.0 if math.isinf(speeds.level) else math.inf)
        climb = max(-min(speeds.down, 1.5), min(_APPROACH * z, min(speeds.up, 3.0)))
        if flat < (0.02 if self.is_sideways else 0.5 * _TOLERANCE):
            level, flat = 0.0, 1.0
        velocity = level * x / flat, level * y / flat
        lead = self._lead
        vx, vy = ((v + lead * (w - v)) if lead > 1.0 else w for w, v in zip(velocity, now.velocity, strict=False))
        self.go((vx, vy, climb), yaw, 0.0, now)

    def go(self, velocity: Triple, yaw: float | None, rate: float, now: Motion) -> None:
        """See `Helm.go`."""
        x, y, z = velocity
        flat = math.hypot(x, y)
        if not self.is_sideways and flat > 1e-6:
            error = math.remainder(math.atan2(y, x) - now.yaw, math.tau)
            forward = flat * math.cos(error) if abs(error) < _ON_THE_SPOT else 0.0
            self.body((forward, 0.0, z), _turn(error), now)
            return
        if yaw is not None:
            rate = _turn(math.remainder(yaw - now.yaw, math.tau))
        c, s = math.cos(now.yaw), math.sin(now.yaw)
        self.body((c * x + s * y, c * y - s * x, z), rate, now)

    def body(self, velocity: Triple, rate: float, now: Motion) -> None:
        """Move with a velocity forward, to the left and up, m/s, and turn to the left, rad/s."""
        x, y, z = velocity
        self.send(linear=(x, y if self.is_sideways else 0.0, z if self.is_vertical else 0.0), angular=(0.0, 0.0, rate))


def _turn(error: float) -> float:
    return max(-_MOST_TURN, min(_TURN * error, _MOST_TURN))


def _between(start: Triple, end: Triple, share: float) -> Triple:
    if share >= 1.0:
        return end
    return tuple(a + (b - a) * share for a, b in zip(start, end, strict=True))  # type: ignore[return-value]
