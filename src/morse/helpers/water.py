"""The box that approximates a vessel in the water."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import product

Triple = tuple[float, float, float]


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
