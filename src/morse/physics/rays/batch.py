"""The rays of one cast."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from morse.physics.rays.embree import single

if TYPE_CHECKING:
    from numpy.typing import NDArray


@dataclass(eq=False, slots=True)
class Batch:
    """Rays, and what they have met so far.

    Rays from one viewpoint follow each other.

    Attributes:
        viewpoints: (B, 3) metres, relative to the anchor of the caster.
        counts: (B,) rays from each viewpoint, N in all.
        directions: (N, 3) unit vectors, world axes.
        distances: (N,) metres to the nearest surface so far; at first, how far to look.
        owners: (B,) the group of solids that the rays from each viewpoint pass through.
        groups: (S,) the group of each solid.
        starts: (N,) metres from which on each ray has left its owner, or None if that is not known.
        clearances: (B,) the largest of these from each viewpoint.
        origins: (N, 3) the viewpoint of each ray.
        solids: (N,) index of the solid met, -1 for none.
        faces: (N,) triangle met: of the static scene if that has the surface of the solid, else of the mesh
            of the solid; of no meaning for other solids.
    """

    viewpoints: NDArray[np.float64]
    counts: NDArray[np.intp]
    directions: NDArray[np.float64]
    distances: NDArray[np.float64]
    owners: NDArray[np.intp]
    groups: NDArray[np.intp]
    starts: NDArray[np.float64] | None = None
    clearances: NDArray[np.float64] | None = None
    origins: NDArray[np.float64] = field(init=False)
    solids: NDArray[np.intp] = field(init=False)
    faces: NDArray[np.int32] = field(init=False)
    _ray_owners: NDArray[np.intp] | None = field(init=False, default=None)
    _columns: tuple[NDArray[np.float64], NDArray[np.float64]] | None = field(init=False, default=None)
    _singles: tuple[NDArray[np.float32], NDArray[np.float32]] | None = field(init=False, default=None)

    def __post_init__(self) -> None:
        self.spread_viewpoints()
        self.solids = np.full(len(self), -1, dtype=np.intp)
        self.faces = np.full(len(self), -1, dtype=np.int32)

    def spread_viewpoints(self) -> None:
        """Give each ray its viewpoint."""
        if len(self.viewpoints) == 1:
            self.origins = np.broadcast_to(self.viewpoints, (len(self), 3))
        else:
            self.origins = self.viewpoints.repeat(self.counts, axis=0)

    def __len__(self) -> int:
        return len(self.distances)

    def disarm(self) -> None:
        """Make rays from or to places that are no numbers so short that they meet nothing."""
        if np.isfinite(self.directions.sum() + self.viewpoints.sum()):
            return
        bad = ~(np.isfinite(self.directions).all(axis=1) & np.isfinite(self.origins).all(axis=1))
        self.directions[bad] = (0.0, 0.0, 1.0)
        self.distances[bad] = -1.0
        self.viewpoints[~np.isfinite(self.viewpoints).all(axis=1)] = 0.0
        self.spread_viewpoints()

    @property
    def ray_owners(self) -> NDArray[np.intp]:
        """(N,) the group that each ray passes through."""
        if self._ray_owners is None:
            self._ray_owners = self.owners.repeat(self.counts)
        return self._ray_owners

    @property
    def columns(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Origins (3, N) and directions (3, N)."""
        if self._columns is None:
            self._columns = np.ascontiguousarray(self.origins.T), np.ascontiguousarray(self.directions.T)
        return self._columns

    @property
    def singles(self) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """Origins and directions in single precision."""
        if self._singles is None:
            self._singles = single(self.origins), single(self.directions)
        return self._singles

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
