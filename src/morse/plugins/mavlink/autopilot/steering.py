"""Chooses how a vehicle is steered, and what it is."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from morse.core.kinds.turning import quaternion_of
from morse.plugins.mavlink.autopilot.car_helm import CarHelm, ForceHelm
from morse.plugins.mavlink.autopilot.helms import GoalHelm, Helm, TwistHelm

if TYPE_CHECKING:
    from collections.abc import Iterable

    from morse.mathutils.rotations import Triple
    from morse.plugins.mavlink.autopilot.helms import Motion, Speeds
    from morse.plugins.mavlink.axes import Place
    from morse.plugins.mavlink.vehicle import Vehicle


_GRAVITY = 9.81
#: gains: velocity per error of the position, 1/s; acceleration per error of the velocity, 1/s; yaw rate, 1/s
_APPROACH, _FOLLOW, _TURN = 0.8, 1.6, 1.5
#: rad, and m/s: limits of setpoints that have none
_MOST_BANK, _MOST_TURN, _MOST_SPEED, _MOST_CLIMB = math.radians(25.0), 1.0, 5.0, 2.0


class AttitudeHelm(Helm):
    """Velocity by the position, acceleration by the velocity, attitude and thrust by the acceleration."""

    def goto(self, goal: Triple, yaw: float | None, speeds: Speeds, now: Motion) -> None:
        """See `Helm.goto`."""
        x, y, z = (_APPROACH * (a - b) for a, b in zip(goal, now.position, strict=True))
        flat, most = math.hypot(x, y), min(speeds.level, _MOST_SPEED)
        share = min(1.0, most / flat) if flat else 0.0
        climb = max(-min(speeds.down, _MOST_CLIMB), min(z, speeds.up, _MOST_CLIMB))
        self.go((x * share, y * share, climb), yaw, 0.0, now)

    def go(self, velocity: Triple, yaw: float | None, rate: float, now: Motion) -> None:
        """See `Helm.go`."""
        x, y, z = (_FOLLOW * (a - b) for a, b in zip(velocity, now.velocity, strict=True))
        c, s = math.cos(now.yaw), math.sin(now.yaw)
        lift = max(0.3 * _GRAVITY, _GRAVITY + z)
        forward, right = c * x + s * y, s * x - c * y
        roll = _limited(math.atan2(right, lift), _MOST_BANK)
        # nose down to fly ahead: a negative pitch
        pitch = -_limited(math.atan2(forward, lift), _MOST_BANK)
        if yaw is not None:
            rate = _limited(_TURN * math.remainder(yaw - now.yaw, math.tau), _MOST_TURN)
        component: Any = self.stream.component_instance
        upright = max(0.5, now.rotation[8])
        share = component.robot_parent.bge_object.mass * lift / upright / component._thrust_factor
        thrust = max(0.0, min(share if component._linear_thrust else math.sqrt(share), 1.0))
        if self._bound.has("rates"):
            self.send(orientation=quaternion_of(roll, pitch, 0.0), rates=(0.0, 0.0, -rate), thrust=thrust)
        else:
            heading = self._place.heading(now.yaw if yaw is None else yaw)
            self.send(orientation=quaternion_of(roll, pitch, heading), thrust=thrust)


def _limited(value: float, most: float) -> float:
    return max(-most, min(value, most))


#: message kinds of the actuators that can steer, the best first
_HELMS: dict[str, type[Helm]] = {"pose": GoalHelm, "twist": TwistHelm, "attitude": AttitudeHelm}
#: MAV_TYPE
QUADROTOR, HELICOPTER, ROVER, BOAT, SUBMARINE = 2, 4, 10, 11, 12
#: MAV_TYPE by classes of robots and actuators, also of those that users derive from them
_TYPES = {
    "RMax": HELICOPTER,
    "Quadrotor": QUADROTOR,
    "Quad2012": QUADROTOR,
    "Rotorcraft": QUADROTOR,
    "StabilizedQuadrotor": QUADROTOR,
    "QuadrotorDynamicControl": QUADROTOR,
    "Submarine": SUBMARINE,
    "Hydrodynamics": BOAT,
}


def helms_of(vehicle: Vehicle, place: Place) -> list[Helm]:
    """What can steer a vehicle, the best first."""
    helms: list[Helm] = []
    for name, cls in _HELMS.items():
        for stream in vehicle.streams:
            for bound in stream.kinds:
                component = stream.component_instance
                moves_body = component.robot_parent is not None and bound.frame != "none"
                has_thrust = name != "attitude" or (bound.has("thrust") and hasattr(component, "_thrust_factor"))
                if bound.kind.name == name and moves_body and has_thrust:
                    of_car = name == "twist" and hasattr(component, "turning_radius")
                    helms.append((CarHelm if of_car else cls)(stream, bound, place))
    cars = [stream for stream in vehicle.streams if hasattr(stream.component_instance, "force_for")]
    return helms + [ForceHelm(stream, stream.kinds[0], place) for stream in cars]


def type_of(robot: object, components: Iterable[object]) -> int:
    """MAV_TYPE of a robot, from the classes of the robot and of its components; a rover if none of them is known."""
    names = [cls.__name__ for one in (robot, *components) for cls in type(one).__mro__]
    return next((_TYPES[name] for name in names if name in _TYPES), ROVER)
