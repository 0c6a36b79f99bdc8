"""Converts values of scripts, and limits them to what the engine accepts.

The limits are wide enough for ships, rockets and satellites. Larger values are mistakes. They are refused on input,
because their products and squares overflow in the engine.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, NamedTuple

from morse.mathutils import Euler, Matrix, Quaternion

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence


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


#: maximum length of a quoted value in messages, characters
_LONGEST = 200


def floats3(value: Iterable[float], what: Quantity) -> tuple[float, float, float]:
    """Convert a value to three floats within the limits of a quantity.

    Raises:
        ValueError: the value is not three numbers, or a number is not finite or too large.
    """
    try:
        x, y, z = value
        x, y, z = float(x), float(y), float(z)
    except (TypeError, ValueError, OverflowError):
        raise ValueError(f"a {what.name} is three numbers [x, y, z], not {_short(value)}") from None
    limit = what.limit
    # comparisons with NaN are false
    if not (-limit <= x <= limit and -limit <= y <= limit and -limit <= z <= limit):
        raise ValueError(
            f"a {what.name} is three finite numbers from {-limit:g} to {limit:g} {what.unit}, not {_short(value)}"
        )
    return x, y, z


def _short(value: object) -> str:
    text = repr(value)
    return text if len(text) <= _LONGEST else text[:_LONGEST] + "..."


def rotation_of(value: Any) -> tuple[float, ...]:
    """Convert a 3x3 matrix, Euler angles or a quaternion (w, x, y, z) to 9 row-major numbers.

    Raises:
        ValueError: the value is none of these, is not finite, or is far from a rotation.
    """
    if isinstance(value, (Euler, Quaternion)):
        value = value.to_matrix()
    elif not isinstance(value, Matrix):
        value = _matrix(value)
    flat = tuple(float(value[i][j]) for i in range(3) for j in range(3))
    demand_rotation(flat)
    return flat


def demand_rotation(flat: Sequence[float]) -> None:
    """Raise ValueError if 9 numbers are far from a rotation matrix."""
    # the sum of numbers that contain NaN is NaN, and comparisons with NaN are false
    if not (min(flat) >= -MATRIX_ENTRY and max(flat) <= MATRIX_ENTRY and abs(sum(flat)) < math.inf):
        raise ValueError(f"the numbers of a rotation matrix are finite and from -1 to 1, not {_short(flat)}")


def _matrix(value: Any) -> Any:
    try:
        items = list(value)
        if len(items) == 3 and all(isinstance(item, (int, float)) for item in items):
            return Euler(items).to_matrix()
        if len(items) == 4 and all(isinstance(item, (int, float)) for item in items):
            return Quaternion(items).to_matrix()
        if len(items) == 3 and all(len(row) == 3 for row in items):
            return items
    except TypeError:
        pass
    raise ValueError(f"an orientation is a 3x3 matrix, Euler angles or a quaternion, not {_short(value)}")
