"""Units and ranges of the physical quantities in commands and arguments of services.

For fields and properties: ``add_data("v", 0.0, "float", "Forward speed", **SPEED)``; for arguments of services: ``def
set_speed(self, v: Speed)``.

The ranges are wide enough for ships and satellites, and narrow enough for the physics engine, which fails if bodies are
1e10 m away. A value outside its range is a mistake of the sender.
"""

from typing import Annotated, TypedDict

from morse.core.validation.arguments import Range


class Limits(TypedDict, total=False):
    """The unit and the range of a quantity."""

    unit: str
    low: float
    high: float


#: m; the centre of the earth is 6.4e6 m away
POSITION: Limits = {"unit": "m", "low": -1e7, "high": 1e7}
LENGTH: Limits = {"unit": "m", "low": 0.0, "high": 1e7}
SPEED: Limits = {"unit": "m/s", "low": -1e4, "high": 1e4}
TURN_RATE: Limits = {"unit": "rad/s", "low": -1e4, "high": 1e4}
FORCE: Limits = {"unit": "N", "low": -1e6, "high": 1e6}
TORQUE: Limits = {"unit": "N·m", "low": -1e6, "high": 1e6}
#: rad; commands may be several turns
ANGLE: Limits = {"unit": "rad", "low": -1e6, "high": 1e6}

Position = Annotated[float, Range(**POSITION)]
Length = Annotated[float, Range(**LENGTH)]
Point = Annotated[list[float], Range(**POSITION, shape=(3,))]
Speed = Annotated[float, Range(**SPEED)]
TurnRate = Annotated[float, Range(**TURN_RATE)]
AbsoluteSpeed = Annotated[float, Range(0.0, SPEED["high"], SPEED["unit"])]
Angle = Annotated[float, Range(**ANGLE)]
EulerAngles = Annotated[list[float], Range(**ANGLE, shape=(3,))]
QuaternionNumbers = Annotated[list[float], Range(low=-1e6, high=1e6, shape=(4,))]
ColorNumbers = Annotated[list[float], Range(low=0.0, high=1.0, shape=(None,))]
