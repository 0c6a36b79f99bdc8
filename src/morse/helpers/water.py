"""The box that approximates a vessel in the water."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from itertools import product

import numpy as np

Triple = tuple[float, float, float]

#: added mass of rectangular plates by the ratio of their sides (DNV-RP-N103)
_RATIOS = (1.0, 1.25, 1.5, 1.59, 2.0, 2.5, 3.0, 4.0, 5.0, 6.25, 8.0, 10.0, 1000.0)
_PLATES = (0.579, 0.642, 0.690, 0.704, 0.757, 0.801, 0.830, 0.871, 0.897, 0.917, 0.934, 0.947, 1.0)


@dataclass(frozen=True)
class Hull:
    """A box that approximates a vessel.

    Attributes:
        centre: position in the frame of the body, m.
        size: lengths along the axes of the body, m.
        drag: force divided by the square of the speed, along the axes of the body, kg/m.
    """

    centre: Triple
    size: Triple
    drag: Triple

    @cached_property
    def cells(self) -> list[Triple]:
        """The centres of the eight parts of the box, in the frame of the body, m."""
        cx, cy, cz = self.centre
        a, b, c = (part / 4.0 for part in self.size)
        return [(cx + i * a, cy + j * b, cz + k * c) for i, j, k in product((-1, 1), repeat=3)]

    @cached_property
    def added(self) -> Triple:
        """The added mass along each axis of the submerged box, as a share of the mass of water that it displaces.

        For a plate with the cross-section of the box, a by b with a < b: C(b/a) pi/4 a^2 b, with the coefficients of
        DNV-RP-N103, "Modelling and analysis of marine operations", appendix A (rectangular plates).
        """
        x, y, z = self.size
        shares = []
        for along, one, other in ((x, y, z), (y, x, z), (z, x, y)):
            short, long = sorted((one, other))
            coefficient = float(np.interp(long / short, _RATIOS, _PLATES))
            shares.append(coefficient * math.pi / 4.0 * short / along)
        return shares[0], shares[1], shares[2]
