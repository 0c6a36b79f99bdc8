"""The rays of one cast."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray


@dataclass(eq=False, slots=True)
class Batch:
    """Rays, and what they have met so far.

    Attributes:
        origins: (N, 3) metres, relative to the anchor of the caster.
        directions: (N, 3) unit vectors, world axes.
        distances: (N,) metres to the nearest surface so far; at first, how far to look.
        owners: (N,) the slot whose solids each ray passes through, or None if there is none.
        solids: (N,) index of the solid met, -1 for none.
        faces: (N,) triangle met, -1 where the solid has none: of the static scene if the solid
            stands still, else of its mesh.
    """

    origins: NDArray[np.float64]
    directions: NDArray[np.float64]
    distances: NDArray[np.float64]
    owners: NDArray[np.intp] | None = None
    solids: NDArray[np.intp] = field(init=False)
    faces: NDArray[np.int32] = field(init=False)

    def __post_init__(self) -> None:
        self.solids = np.full(len(self.distances), -1, dtype=np.intp)
        self.faces = np.full(len(self.distances), -1, dtype=np.int32)

    def __len__(self) -> int:
        return len(self.distances)

    def meet(
        self,
        rays: NDArray[np.intp],
        distances: NDArray[np.float64],
        solids: NDArray[np.intp],
        faces: NDArray[np.int32],
    ) -> None:
        """Note that some rays (K,), each named once, meet a surface, where that is nearer than all before."""
        nearer = np.flatnonzero(distances < self.distances.take(rays))
        if len(nearer):
            rays = rays.take(nearer)
            self.distances[rays] = distances.take(nearer)
            self.solids[rays] = solids.take(nearer)
            self.faces[rays] = faces.take(nearer)
