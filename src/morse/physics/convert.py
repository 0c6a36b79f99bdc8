"""Takes the many forms in which scripts give vectors and rotations."""

from __future__ import annotations

import math
from typing import Any

from morse.mathutils import Euler, Matrix, Quaternion


def floats3(value: Any, what: str) -> tuple[float, float, float]:
    """Three finite floats.

    Raises:
        ValueError: if they are not three, not numbers or not finite.
    """
    try:
        x, y, z = value
        x, y, z = float(x), float(y), float(z)
    except (TypeError, ValueError):
        raise ValueError(f"a {what} is three numbers [x, y, z], not {value!r}") from None
    # 0 times an infinite number is no number
    if 0.0 * x + 0.0 * y + 0.0 * z != 0.0:
        raise ValueError(f"a {what} is three finite numbers, not {value!r}")
    return x, y, z


def rotation_of(value: Any) -> tuple[float, ...]:
    """9 row-major numbers of a rotation given as 3x3 matrix, Euler angles or quaternion (w, x, y, z).

    Raises:
        ValueError: if it is none of them, or not finite.
    """
    if isinstance(value, (Euler, Quaternion)):
        value = value.to_matrix()
    elif not isinstance(value, Matrix):
        value = _matrix(value)
    flat = tuple(float(value[i][j]) for i in range(3) for j in range(3))
    if not all(map(math.isfinite, flat)):
        raise ValueError(f"an orientation has finite numbers, not {value!r}")
    return flat


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
    raise ValueError(f"an orientation is a 3x3 matrix, Euler angles or a quaternion, not {value!r}")
