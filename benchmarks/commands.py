"""Commands for actuators during a measurement, so that each does all of its work in every tick."""

from __future__ import annotations

import math
from typing import Any

#: fields that change during a measurement: the amplitude of a sine of half a hertz
_SWINGING = {"PA10": 1.0, "KukaLWR": 1.0, "Armature": 1.0, "PTU": 1.0}
_FIXED: dict[str, dict[str, Any]] = {
    "MotionVW": {"v": 0.5, "w": 0.3},
    "MotionVWDiff": {"v": 0.5, "w": 0.3},
    "MotionXYW": {"x": 0.5, "y": 0.1, "w": 0.3},
    "Waypoint": {"x": 400.0, "y": 100.0, "speed": 0.5},
    "Destination": {"x": 400.0, "y": 100.0},
    "ForceTorque": {"force": [20.0, 0.0, 0.0], "torque": [0.0, 0.0, 5.0]},
    "ExternalForce": {"force": [20.0, 0.0, 0.0]},
    "SteerForce": {"steer": 0.2, "force": -20.0},
    "RotorcraftVelocity": {"vx": 1.0, "vy": 0.2, "vyaw": 0.1},
    "RotorcraftAttitude": {"thrust": 0.49, "pitch": 0.02},
    "RotorcraftWaypoint": {"x": 400.0, "y": 100.0, "z": 6.0},
    "StabilizedQuadrotor": {"theta_c": 0.05, "h_c": 6.0},
    "QuadrotorDynamicControl": {"engines": [731.0, 731.0, 731.0, 731.0]},
    "Gripper": {"grab": True},
    "LedArray": {"intervals": [[0.05] * 8] * 8},
}


def command(name: str, component: Any, time: float) -> None:
    """Command a component for this tick.

    Args:
        name: name of its class in scene scripts.
        time: simulated time, s.
    """
    data = component.local_data
    if name in _FIXED:
        data.update({field: value for field, value in _FIXED[name].items() if field in data})
    elif name in _SWINGING:
        angle = _SWINGING[name] * math.sin(math.pi * time)
        data.update(dict.fromkeys(data, angle))
    elif name == "Teleport":
        data.update(x=1.0 + 0.1 * time, y=0.2, z=0.0, yaw=0.1 * time)
    elif name == "Arucomarker":
        data.update(x=0.1 * time)
    elif name == "Orientation":
        data.update(yaw=math.remainder(0.5 * time, math.tau))
