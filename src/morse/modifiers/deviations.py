"""Standard deviations in scene scripts: one for all axes, or one for each axis."""

from __future__ import annotations

import math
from typing import Any

from morse.core.exceptions import MorseBuilderError
from morse.core.reports.hints import nearest
from morse.core.reports.quoting import shown


def deviations(option: str, numbers: Any, axes: tuple[str, ...]) -> dict[str, float]:
    """Return the standard deviation of each axis; axes that are missing in a dictionary are omitted.

    Args:
        option: name of the option, for messages.
        numbers: a number of at least 0, or a dictionary of such numbers.
        axes: the keys that the dictionary may have.

    Raises:
        MorseBuilderError: the value is neither of the two.
    """
    by_axis = numbers if isinstance(numbers, dict) else dict.fromkeys(axes, numbers)
    for axis, value in by_axis.items():
        if axis not in axes:
            raise MorseBuilderError(f"option '{option}' has no axis {shown(axis)}{nearest(axis, axes)}")
        if isinstance(value, bool) or not isinstance(value, (int, float)) or not 0.0 <= value < math.inf:
            raise MorseBuilderError(f"option '{option}' takes a standard deviation of at least 0, not {shown(value)}")
    return {axis: float(by_axis.get(axis, 0.0)) for axis in axes}
