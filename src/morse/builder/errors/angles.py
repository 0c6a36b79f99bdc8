"""Angles that look like degrees."""

from __future__ import annotations

import logging
import math
from numbers import Real
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable

logger = logging.getLogger(__name__)


def hint_at_radians(what: str, angles: Iterable[object]) -> None:
    """Warn about angles of more than a full turn, because they are most likely degrees.

    Args:
        what: name of the call in the message, e.g. ``Morsy.rotate``.
        angles: the arguments of the script; values that are not numbers are skipped.
    """
    for angle in angles:
        if (
            isinstance(angle, Real)
            and not isinstance(angle, bool)
            and 2.0 * math.pi + 1e-6 < abs(float(angle)) < math.inf
        ):
            logger.warning(
                "%s takes radians, and %g rad are %.3g turns; for degrees write math.radians(%g)",
                what,
                angle,
                angle / (2.0 * math.pi),
                angle,
            )
            return
