"""The solids that move: boxes around them, made anew when they have moved."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from morse.physics.rays.boxes import Boxes
from morse.physics.rays.embree import TriangleScene
from morse.physics.rays.sweep import sweep
from morse.physics.rays.triangles import BOX_TRIANGLES

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from morse.physics.rays.batch import Batch
    from morse.physics.rays.narrow import Narrow

#: up to so many rays, or so many pairs of rays and solids, each ray is compared with each solid: that is quicker
#: than making triangles; but never more pairs than the last number, for the sake of memory
_FEW_RAYS, _FEW_PAIRS, _MOST_PAIRS = 1000, 200_000, 4_000_000
#: solids are compared with each other if there are at least that many rays for each pair
_RAYS_A_PAIR = 0.1


class MovingScene:
    """Some solids, as they are at one moment."""

    def __init__(self, narrow: Narrow, members: NDArray[np.intp], grain: float) -> None:
        self._narrow = narrow
        self._grain = grain
        self._boxes = Boxes(narrow, members, grain)
        self._scene: TriangleScene | None = None
        self._solid_of = members.repeat(len(BOX_TRIANGLES))
        self._alone: NDArray[np.bool_] | None = None

    def cast(self, batch: Batch) -> None:
        """Find what each ray meets first."""
        rays, solids = len(batch), len(self._boxes)
        if self._scene is None:
            pairs = rays * solids
            if pairs <= _FEW_PAIRS or (rays <= _FEW_RAYS and pairs <= _MOST_PAIRS):
                self._compare(batch)
                return
            first = np.arange(0, 8 * solids, 8, dtype=np.int32)
            faces = BOX_TRIANGLES + first[:, None, None]
            self._scene = TriangleScene(self._boxes.corners().reshape(-1, 3), faces.reshape(-1, 3))
        if self._alone is None and rays >= _RAYS_A_PAIR * solids**2:
            self._alone = self._boxes.alone()
        crowded = self._boxes.look_around(batch)
        starts = batch.starts
        if starts is not None and crowded.any():
            # something is near enough to reach into the boxes of the owner itself
            starts = np.where(crowded.repeat(batch.counts), 0.0, starts)
        self._batch = batch
        sweep(
            self._scene,
            self._solid_of,
            self._resolve,
            batch,
            self._grain,
            owned=True,
            alone=self._alone,
            starts=starts,
        )

    def _resolve(
        self, rays: NDArray[np.intp], faces: NDArray[np.int32], rough: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
        return self._narrow.first_surface(self._batch, rays, self._solid_of.take(faces))

    def _compare(self, batch: Batch) -> None:
        """Each ray with each solid whose bounding sphere it passes through."""
        members, middles, radii = self._boxes.members, self._boxes.middles, self._boxes.radii * 1.001
        squares = ((batch.viewpoints[:, None] - middles) ** 2).sum(axis=2)
        # a ray that touches a sphere goes along at least that far until it is nearest to the middle
        tangents = np.sqrt(np.maximum(squares * (1.0 - 1e-12) - radii**2, 0.0))
        tangents[squares <= radii**2] = -np.inf
        tangents[batch.groups.take(members) == batch.owners[:, None]] = np.inf
        along = batch.directions @ middles.T
        along -= np.einsum("ij,ij->i", batch.directions, batch.origins)[:, None]
        rays, chosen = (along >= tangents.repeat(batch.counts, axis=0)).nonzero()
        near = along[rays, chosen] - radii.take(chosen) <= batch.distances.take(rays)
        rays, chosen = rays[near], chosen[near]
        if not len(rays):
            return
        solids = members.take(chosen)
        distances, faces = self._narrow.first_surface(batch, rays, solids)
        # the pairs are sorted by ray: keep the nearest of each
        firsts = np.flatnonzero(np.concatenate([[True], rays[1:] != rays[:-1]]))
        counts = np.diff(firsts, append=len(rays))
        nearest = np.flatnonzero(distances == np.minimum.reduceat(distances, firsts).repeat(counts))
        batch.meet(rays.take(nearest), distances.take(nearest), solids.take(nearest), faces.take(nearest))
