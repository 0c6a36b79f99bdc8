"""Chooses how a vehicle is steered, and what it is."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.plugins.mavlink.autopilot.attitude_helm import AttitudeHelm
from morse.plugins.mavlink.autopilot.car_helm import CarHelm, ForceHelm
from morse.plugins.mavlink.autopilot.helms import GoalHelm, TwistHelm

if TYPE_CHECKING:
    from collections.abc import Iterable

    from morse.plugins.mavlink.autopilot.helms import Helm
    from morse.plugins.mavlink.autopilot.place import Place
    from morse.plugins.mavlink.vehicle import Vehicle

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
