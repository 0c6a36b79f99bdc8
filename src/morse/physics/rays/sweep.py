"""Follows rays through triangles that stand around solids, until they meet one."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from morse.physics.rays.embree import single

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from morse.physics.rays.batch import Batch
    from morse.physics.rays.embree import TriangleScene

    #: from rays (K,), the triangles (K,) that they cross and the rough distances (K,) of these, to
    #: the distance (K,) of the solid behind each triangle, and the triangle (K,) of it
    Resolve = Callable[
        [NDArray[np.intp], NDArray[np.int32], NDArray[np.float64]], tuple[NDArray[np.float64], NDArray[np.int32]]
    ]

#: a ray crosses at most that many triangles: it must end, even if single precision fails us
_MOST_CROSSINGS = 1000


def margins(solids: NDArray[np.intp], grain: float) -> NDArray[np.float64]:
    """Metres (K,) by which the boxes around some solids (K,) are larger than these, each by another length.

    Faces that coincide would be taken for one, and the solid behind the second one would be missed.
    """
    return np.asarray(grain * (2.0 + 3.0 * (solids % 1024)))


def sweep(
    scene: TriangleScene,
    solid_of: NDArray[np.intp],
    resolve: Resolve,
    batch: Batch,
    grain: float,
    *,
    owned: bool,
    alone: NDArray[np.bool_] | None = None,
    starts: NDArray[np.float64] | None = None,
) -> None:
    """Find the nearest surface of each ray.

    A triangle is a surface itself or part of a box around one. Where a ray crosses it, the distance
    of the surface is worked out; the ray goes on behind the crossing as long as something nearer
    than what it has met may come, and through everything that belongs to its owner.

    Args:
        solid_of: (T,) the solid behind each triangle.
        grain: metres by which single precision may be wrong here.
        owned: False if no triangle belongs to the owner of a ray.
        alone: (S,) the solids that have no other in their boxes: nothing can come before them.
        starts: (N,) metres from which on each ray can meet anything.
    """
    origins, directions = batch.singles
    if starts is None:
        faces, step = scene.cast(origins, directions, single(batch.distances + grain))
    else:
        moved = single(batch.origins + batch.directions * starts[:, None])
        faces, step = scene.cast(moved, directions, single(batch.distances - starts + grain))
    rays = np.flatnonzero(faces >= 0)
    faces = faces.take(rays)
    travelled = step.take(rays).astype(np.float64)
    if starts is not None:
        travelled += starts.take(rays)
    for _ in range(_MOST_CROSSINGS):
        solids = solid_of.take(faces)
        if owned:
            own = batch.groups.take(solids) == batch.ray_owners.take(rays)
            found = np.full(len(rays), np.inf)
            foreign = np.flatnonzero(~own)
            if len(foreign):
                chosen = rays.take(foreign)
                found[foreign], triangles = resolve(chosen, faces.take(foreign), travelled.take(foreign))
                batch.meet(chosen, found.take(foreign), solids.take(foreign), triangles)
        else:
            found, triangles = resolve(rays, faces, travelled)
            batch.meet(rays, found, solids, triangles)
        travelled += grain
        left = batch.distances.take(rays) - travelled
        onward = left > 0.0
        if alone is not None:
            onward &= ~((found < np.inf) & alone.take(solids))
        going = np.flatnonzero(onward)
        if not len(going):
            return
        rays, travelled, left = rays.take(going), travelled.take(going), left.take(going)
        ways = batch.directions.take(rays, axis=0)
        places = batch.origins.take(rays, axis=0) + ways * travelled[:, None]
        faces, step = scene.cast(single(places), single(ways), single(left + grain))
        going = np.flatnonzero(faces >= 0)
        rays, faces = rays.take(going), faces.take(going)
        travelled = travelled.take(going) + step.take(going)
