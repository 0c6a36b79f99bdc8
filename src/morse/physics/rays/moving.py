"""The solids that move: boxes around them, made anew when they have moved."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from morse.physics.rays.embree import TriangleScene
from morse.physics.rays.sweep import margins, sweep
from morse.physics.rays.triangles import BOX_CORNERS, BOX_TRIANGLES

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from morse.physics.rays.batch import Batch
    from morse.physics.rays.narrow import Narrow

#: up to so many rays each ray is compared with each solid: that is quicker than making triangles
FEW_RAYS = 64
#: pairs of rays and solids that are compared in one go: 16 MB of arrays
_MOST_PAIRS = 1 << 19
#: up to so many solids are compared with each other
_MOST_COMPARED = 2000


class MovingScene:
    """Some solids, as they are at one moment."""

    def __init__(self, narrow: Narrow, members: NDArray[np.intp], grain: float) -> None:
        self._narrow = narrow
        self._members = members
        self._grain = grain
        solids = narrow.solids
        self._halves = solids.halves[members] + margins(members, grain)[:, None]
        turned = np.einsum("sij,sj->si", narrow.rotations[members], solids.centres[members])
        self._middles = narrow.positions[members] + turned
        self._radii = np.linalg.norm(self._halves, axis=1)
        self._scene: TriangleScene | None = None
        self._solid_of: NDArray[np.intp]
        self._alone: NDArray[np.bool_]

    def cast(self, batch: Batch) -> None:
        """Find what each ray meets first."""
        if len(batch) <= FEW_RAYS and self._scene is None:
            self._compare(batch)
            return
        if self._scene is None:
            self._build()
        assert self._scene is not None
        self._batch = batch
        starts = self._look_around(batch)
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

    def _build(self) -> None:
        """The boxes as triangles."""
        local = BOX_CORNERS * self._halves[:, None, :]
        rotations = self._narrow.rotations.take(self._members, axis=0)
        corners = local @ rotations.transpose(0, 2, 1) + self._middles[:, None, :]
        first = np.arange(0, 8 * len(self._members), 8, dtype=np.int32)
        faces = BOX_TRIANGLES + first[:, None, None]
        self._solid_of = self._members.repeat(len(BOX_TRIANGLES))
        self._scene = TriangleScene(corners.reshape(-1, 3), faces.reshape(-1, 3))
        self._alone = np.zeros(len(self._narrow.positions), dtype=bool)
        if len(self._members) <= _MOST_COMPARED:
            self._alone[self._members] = _near(self._middles, self._radii, self._middles, self._radii).sum(axis=1) == 1

    def _resolve(
        self, rays: NDArray[np.intp], faces: NDArray[np.int32], rough: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
        return self._narrow.first_surface(self._batch, rays, self._solid_of.take(faces))

    def _look_around(self, batch: Batch) -> NDArray[np.float64] | None:
        """Meet the solids whose boxes hold a viewpoint: a ray crosses such a box only on its way out.

        Returns:
            (N,) metres from which on each ray can meet anything else, or None.
        """
        clearances = np.zeros(len(batch.viewpoints)) if batch.clearances is None else batch.clearances
        viewpoints, boxes = _near(batch.viewpoints, clearances, self._middles, self._radii).nonzero()
        solids = self._members.take(boxes)
        foreign = np.flatnonzero(batch.groups.take(solids) != batch.owners.take(viewpoints))
        if not len(foreign):
            return batch.starts
        viewpoints, boxes, solids = viewpoints.take(foreign), boxes.take(foreign), solids.take(foreign)
        apart = batch.viewpoints.take(viewpoints, axis=0) - self._middles.take(boxes, axis=0)
        local = np.einsum("kij,ki->kj", self._narrow.rotations.take(solids, axis=0), apart)
        inside = (np.abs(local) <= self._halves.take(boxes, axis=0)).all(axis=1)
        firsts = np.cumsum(batch.counts) - batch.counts
        for viewpoint, solid in zip(viewpoints[inside].tolist(), solids[inside].tolist(), strict=True):
            rays = np.arange(firsts[viewpoint], firsts[viewpoint] + batch.counts[viewpoint])
            which = np.full(len(rays), solid)
            distances, faces = self._narrow.first_surface(batch, rays, which)
            batch.meet(rays, distances, which, faces)
        if batch.starts is None:
            return None
        # something is near enough to reach into what the owner's own boxes take up
        crowded = np.zeros(len(batch.viewpoints), dtype=bool)
        crowded[viewpoints] = True
        return np.where(crowded.repeat(batch.counts), 0.0, batch.starts)

    def _compare(self, batch: Batch) -> None:
        """Each ray with each solid whose bounding sphere it passes through."""
        step = max(1, _MOST_PAIRS // len(self._members))
        for first in range(0, len(batch), step):
            chosen = slice(first, first + step)
            directions = batch.directions[chosen]
            apart = self._middles - batch.origins[chosen, None, :]
            along = np.einsum("nsi,ni->ns", apart, directions)
            across = np.einsum("nsi,nsi->ns", apart, apart) - along**2
            reached = (across <= (self._radii * 1.001) ** 2) & (along >= -self._radii)
            reached &= along - self._radii <= batch.distances[chosen, None]
            rays, boxes = reached.nonzero()
            rays += first
            solids = self._members.take(boxes)
            foreign = np.flatnonzero(batch.groups.take(solids) != batch.ray_owners.take(rays))
            rays, solids = rays.take(foreign), solids.take(foreign)
            if not len(rays):
                continue
            distances, faces = self._narrow.first_surface(batch, rays, solids)
            # of several solids on one ray the nearest one comes last, and stays
            order = np.argsort(-distances, kind="stable")
            rays, distances = rays.take(order), distances.take(order)
            last = len(rays) - 1 - np.unique(rays[::-1], return_index=True)[1]
            batch.meet(
                rays.take(last), distances.take(last), solids.take(order).take(last), faces.take(order).take(last)
            )


def _near(
    points: NDArray[np.float64], reaches: NDArray[np.float64], middles: NDArray[np.float64], radii: NDArray[np.float64]
) -> NDArray[np.bool_]:
    """(B, S) whether balls about some points (B,) and others (S,) touch, nearly so included."""
    squares = (points**2).sum(axis=1)[:, None] + (middles**2).sum(axis=1) - 2.0 * points @ middles.T
    limits = (reaches[:, None] + radii) ** 2
    # what is left of such a difference is good to some units in the last place of the squares
    return np.asarray(squares <= limits * 1.001 + 1e-12 * (limits + np.abs(points).max() ** 2 + 1.0))
