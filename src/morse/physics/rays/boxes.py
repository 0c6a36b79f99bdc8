"""Boxes around solids, and the viewpoints within them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from morse.physics.rays.sweep import margins
from morse.physics.rays.triangles import BOX_CORNERS

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from morse.physics.rays.batch import Batch
    from morse.physics.rays.narrow import Narrow


class Boxes:
    """A box around each of some solids, as they are now.

    Attributes:
        members: (K,) the solids.
        middles: (K, 3) metres, relative to the anchor of the caster.
        radii: (K,) of the spheres around the boxes.
    """

    def __init__(self, narrow: Narrow, members: NDArray[np.intp], grain: float) -> None:
        self._narrow = narrow
        self.members = members
        self._halves = narrow.solids.halves[members] + margins(members, grain)[:, None]
        self._rotations = narrow.rotations.take(members, axis=0)
        centres = narrow.solids.centres[members]
        self.middles = narrow.positions[members] + np.einsum("kij,kj->ki", self._rotations, centres)
        self.radii = np.linalg.norm(self._halves, axis=1)

    def __len__(self) -> int:
        return len(self.members)

    def corners(self) -> NDArray[np.float64]:
        """(K, 8, 3) metres, relative to the anchor."""
        local = BOX_CORNERS * self._halves[:, None, :]
        return np.asarray(local @ self._rotations.transpose(0, 2, 1) + self.middles[:, None, :])

    def alone(self) -> NDArray[np.bool_]:
        """(S,) of all solids of the world, those whose boxes here touch no other one here."""
        result = np.zeros(len(self._narrow.positions), dtype=bool)
        result[self.members] = self._near(self.middles, self.radii).sum(axis=1) == 1
        return result

    def look_around(self, batch: Batch) -> NDArray[np.bool_]:
        """Meet the solids whose boxes hold a viewpoint: a ray crosses such a box only on its way out.

        Returns:
            (B,) the viewpoints that have a box within their clearance.
        """
        crowded = np.zeros(len(batch.viewpoints), dtype=bool)
        reaches = crowded.astype(np.float64) if batch.clearances is None else batch.clearances
        viewpoints, boxes = self._near(batch.viewpoints, reaches).nonzero()
        solids = self.members.take(boxes)
        foreign = np.flatnonzero(batch.groups.take(solids) != batch.owners.take(viewpoints))
        if not len(foreign):
            return crowded
        viewpoints, boxes, solids = viewpoints.take(foreign), boxes.take(foreign), solids.take(foreign)
        crowded[viewpoints] = True
        apart = batch.viewpoints.take(viewpoints, axis=0) - self.middles.take(boxes, axis=0)
        local = np.einsum("kij,ki->kj", self._rotations.take(boxes, axis=0), apart)
        inside = (np.abs(local) <= self._halves.take(boxes, axis=0)).all(axis=1)
        firsts = np.cumsum(batch.counts) - batch.counts
        for viewpoint, solid in zip(viewpoints[inside].tolist(), solids[inside].tolist(), strict=True):
            rays = np.arange(firsts[viewpoint], firsts[viewpoint] + batch.counts[viewpoint])
            which = np.full(len(rays), solid)
            distances, faces = self._narrow.first_surface(batch, rays, which)
            batch.meet(rays, distances, which, faces)
        return crowded

    def _near(self, points: NDArray[np.float64], reaches: NDArray[np.float64]) -> NDArray[np.bool_]:
        """(B, K) whether balls about some points (B, 3) touch the spheres around the boxes, or nearly so."""
        squares = (points**2).sum(axis=1)[:, None] + (self.middles**2).sum(axis=1) - 2.0 * points @ self.middles.T
        limits = (reaches[:, None] + self.radii) ** 2
        # what is left of such a difference is good to some units in the last place of the squares
        slack = 1e-12 * (limits + np.abs(points).max(initial=0.0) ** 2 + 1.0)
        return np.asarray(squares <= limits * 1.001 + slack)
