"""The limits of the values that the engine accepts.

The limits are wide enough for ships, rockets and satellites. Larger values are mistakes. They are refused on input,
because their products and squares overflow in the engine.
"""

from __future__ import annotations

from typing import NamedTuple


class Quantity(NamedTuple):
    """The kind of a vector, and the limit of its components.

    Attributes:
        name: name in messages.
        limit: the largest absolute value of a component.
        unit: unit of the components.
    """

    name: str
    limit: float
    unit: str


#: m; the centre of the earth is 6.4e6 m away
POSITION = Quantity("position", 1e7, "m")
MOVEMENT = Quantity("movement", 1e7, "m")
ROTATION = Quantity("rotation", 1e6, "rad")
VELOCITY = Quantity("velocity", 1e5, "m/s")
ANGULAR_VELOCITY = Quantity("angular velocity", 1e5, "rad/s")
FORCE = Quantity("force", 1e9, "N")
TORQUE = Quantity("torque", 1e9, "N m")
#: targets of rays, limited by single precision
POINT = Quantity("point", 1e30, "m")

#: limit of the entries of a rotation matrix, which are at most 1 without scale and shear
MATRIX_ENTRY = 10.0

#: speed (m/s, rad/s) and distance (m) above which a body has diverged, because no input can be that large
RUNAWAY_SPEED, RUNAWAY_DISTANCE = 1e6, 1e9
