"""How large the numbers are that the engine takes.

They are wide enough for ships, rockets and satellites. What is larger is a mistake, and is refused where it enters: the
engine squares and multiplies such numbers until none are left.
"""

from __future__ import annotations

from typing import NamedTuple


class Quantity(NamedTuple):
    """What a vector is, and how large its components may be.

    Attributes:
        name: as messages call it.
        limit: the largest absolute value of a component.
        unit: of the components.
    """

    name: str
    limit: float
    unit: str


#: the centre of the earth is 6.4e6 m away
POSITION = Quantity("position", 1e7, "m")
MOVEMENT = Quantity("movement", 1e7, "m")
ROTATION = Quantity("rotation", 1e6, "rad")
VELOCITY = Quantity("velocity", 1e5, "m/s")
ANGULAR_VELOCITY = Quantity("angular velocity", 1e5, "rad/s")
FORCE = Quantity("force", 1e9, "N")
TORQUE = Quantity("torque", 1e9, "N m")
#: where rays go to; they end where single precision does
POINT = Quantity("point", 1e30, "m")

#: entries of a rotation matrix are at most 1; scaled and sheared ones are taken as far as that
MATRIX_ENTRY = 10.0

#: what moves faster (m/s, rad/s), or is farther away (m), than anything that was asked for has blown up
RUNAWAY_SPEED, RUNAWAY_DISTANCE = 1e6, 1e9
