"""Converts vectors and rotations from the forms that scripts use."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from morse.mathutils import Euler, Matrix, Quaternion
from morse.physics.model.limits import MATRIX_ENTRY

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from morse.physics.model.limits import Quantity

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
