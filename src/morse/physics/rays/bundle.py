"""The rays of one sensor."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Protocol

import numpy as np

from morse.kernel.rays import Hits
from morse.mathutils.portable import matmul

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike, NDArray

    from morse.physics.objects.gameobject import GameObject
    from morse.physics.rays.solids import Solids
    from morse.scene import Node


#: largest distance, because larger values would overflow single precision
_FARTHEST = 1e30


def farther(reach: float) -> float:
    """Return the next floating-point number after a reach, m, so that hits exactly at the reach are included."""
    return math.nextafter(min(reach, _FARTHEST), math.inf)


class Scan:
    """The results of one or more bundles of the same shape, one row per bundle.

    Attributes:
        distances: (B, N) m, infinite for no hit.
        solids: (B, N) index of the solid, -1 for no hit.
        faces: (B, N) triangle of the mesh of the solid, -1 for other solids.
        known: the solids to which the indices refer; None before the first cast.
        directions, reach: of the bundles, see `RayBundle`.
    """

    __slots__ = ("_origins", "_points", "_ranges", "directions", "distances", "faces", "known", "reach", "solids")

    def __init__(self, bundle: RayBundle, hits: Hits, solids: Solids | None = None) -> None:
        self.known = solids
        self.directions, self._origins, self.reach = bundle.directions, bundle.origins, bundle.reach
        self.distances, self.solids, self.faces = hits
        self._points: NDArray[np.float64] | None = None
        self._ranges: NDArray[np.float64] | None = None

    def ranges(self) -> NDArray[np.float64]:
        """(B, N) m, the reach for no hit; computed for all bundles at the first access."""
        if self._ranges is None:
            self._ranges = np.minimum(self.distances, self.reach)
        return self._ranges

    def points(self) -> NDArray[np.float64]:
        """(B, N, 3) m in the frame of each sensor, zeros for no hit."""
        if self._points is None:
            length = np.where(self.solids >= 0, self.distances, 0.0)[..., None]
            # avoids -0.0 in the numbers that clients read
            self._points = self.directions * length + 0.0
            if self._origins is not None:
                self._points += np.where(length > 0.0, self._origins, 0.0)
        return self._points


class Sight:
    """The results of one bundle in one cast; it does not change at the next cast.

    Attributes:
        scan: the results of all bundles that were cast together with it.
        row: its row in the arrays of ``scan``.
    """

    __slots__ = ("row", "scan")

    def __init__(self, scan: Scan, row: int) -> None:
        self.scan, self.row = scan, row

    @property
    def distances(self) -> NDArray[np.float64]:
        """(N,) distance of each hit, m; infinite for no hit."""
        row: NDArray[np.float64] = self.scan.distances[self.row]
        return row

    @property
    def ranges(self) -> NDArray[np.float64]:
        """(N,) distance of each hit, m; the reach for no hit."""
        row: NDArray[np.float64] = self.scan.ranges()[self.row]
        return row

    @property
    def points(self) -> NDArray[np.float64]:
        """(N, 3) hit points in the frame of the sensor, m; [0, 0, 0] for no hit."""
        row: NDArray[np.float64] = self.scan.points()[self.row]
        return row

    @property
    def hit(self) -> NDArray[np.int64]:
        """(N,) number of the solid at each hit; -1 for no hit."""
        row: NDArray[np.int64] = self.scan.solids[self.row]
        return row

    @property
    def faces(self) -> NDArray[np.int32]:
        """(N,) triangle of the mesh of the solid at each hit; -1 for other solids."""
        row: NDArray[np.int32] = self.scan.faces[self.row]
        return row

    @property
    def nodes(self) -> Sequence[Node]:
        """[S] nodes of the solids, by the numbers in ``hit``."""
        solids = self.scan.known
        return solids.nodes if solids is not None else ()

    @property
    def remissions(self) -> NDArray[np.float64]:
        """(N,) ``specular`` of the material at each hit; 0 for no hit."""
        solids = self.scan.known
        return solids.remissions_of(self.hit, self.faces) if solids is not None else np.zeros(len(self.hit))


class Casting(Protocol):
    """The part of `Rays` that bundles need."""

    @property
    def stamp(self) -> int:
        """A value that changes whenever an object has moved."""

    def cast(self, bundles: Sequence[RayBundle]) -> None:
        """Cast the rays of some sensors."""

    def serve(self, requests: Sequence[RayBundle]) -> None:
        """Cast the bundles that components have requested for a tick."""

    def normals_of(self, bundle: RayBundle) -> NDArray[np.float64]:
        """See `RayBundle.normals`."""

    def velocities_of(self, bundle: RayBundle) -> NDArray[np.float64]:
        """See `RayBundle.velocities`."""

    def checked_directions(self, directions: ArrayLike) -> NDArray[np.float64]:
        """Validate directions (N, 3) and return them as unit vectors."""

    def object_at(self, node: Node) -> GameObject | None:
        """The object of a node, if the node is still in the world."""


class RayBundle:
    """The rays of one sensor, and the results of the last cast.

    Attributes:
        obj: the object in whose frame the rays are given; the rays ignore the robot of the object.
        origins: (N, 3) m in the frame of the object, or None if all rays start at its origin.
        directions: (N, 3) unit vectors in the frame of the object; the array must not be modified.
        reach: largest distance of a hit, m.
        upright: whether the rays are given along the axes of the world and do not rotate with the object.
        limit: the next number after ``reach``; hits have smaller distances.
        sight: the results of the last cast.
        stamp: stamp of the world at the last cast.
    """

    #: components create their bundles themselves, so the results are not part of the state
    is_apparatus = True

    def __init__(
        self,
        rays: Casting,
        obj: GameObject,
        directions: NDArray[np.float64],
        reach: float,
        origins: NDArray[np.float64] | None,
        upright: bool,
    ) -> None:
        self._rays = rays
        self.obj = obj
        self.directions = directions
        self.reach, self.limit = reach, farther(reach)
        self.origins = origins
        self.upright = upright
        self.stamp = -1
        self.sight = Sight(Scan(self, Hits.nothing((1, len(directions)))), 0)

    def __len__(self) -> int:
        return len(self.directions)

    @property
    def server(self) -> Casting:
        """The server that casts these rays together with those of other sensors (see `morse.core.requests`)."""
        return self._rays

    @property
    def shape(self) -> tuple[int, int, float, bool]:
        """A key that is equal for bundles that can be processed together."""
        return id(self.directions), id(self.origins), self.reach, self.upright

    def turn_to(self, directions: ArrayLike) -> None:
        """Set other directions: (N, 3) vectors of nonzero length, in the frame of the object."""
        self.directions = self._rays.checked_directions(directions)
        self.stamp = -1

    def take(self, scan: Scan, row: int, stamp: int) -> None:
        """Store the results of a cast."""
        self.sight, self.stamp = Sight(scan, row), stamp

    def refresh(self) -> None:
        """Cast the rays now, unless no object has moved since the last cast."""
        if self.stamp != self._rays.stamp:
            self._rays.cast([self])

    @property
    def distances(self) -> NDArray[np.float64]:
        """(N,) distance of each hit, m; infinite for no hit."""
        return self.sight.distances

    @property
    def ranges(self) -> NDArray[np.float64]:
        """(N,) distance of each hit, m; the reach for no hit."""
        return self.sight.ranges

    @property
    def points(self) -> NDArray[np.float64]:
        """(N, 3) hit points in the frame of the sensor, m; [0, 0, 0] for no hit."""
        return self.sight.points

    @property
    def hit(self) -> NDArray[np.int64]:
        """(N,) number of the solid at each hit, see `object_of`; -1 for no hit."""
        return self.sight.hit

    @property
    def remissions(self) -> NDArray[np.float64]:
        """(N,) reflectance, 0..1: the ``specular`` of the material at each hit; 0 for no hit."""
        return self.sight.remissions

    @property
    def normals(self) -> NDArray[np.float64]:
        """(N, 3) unit vectors perpendicular to the surface at each hit, on the side of the sensor; zeros for no hit.

        They are given like the directions, and computed from the present poses: read them in the tick of the cast.
        """
        return self._rays.normals_of(self)

    @property
    def velocities(self) -> NDArray[np.float64]:
        """(N, 3) velocity over the ground of the surface at each hit, m/s, given like the directions; zeros for no hit.

        They are computed from the present motion: read them in the tick of the cast.
        """
        return self._rays.velocities_of(self)

    def frame(self) -> tuple[Sequence[float], NDArray[np.float64]]:
        """Return the position (3,) of the object in the world, m, and the rotation (3, 3) of the rays to the world."""
        position, rotation = self.obj.world_pose()
        return position, np.eye(3) if self.upright else np.reshape(rotation, (3, 3))

    def object_of(self, ray: int) -> GameObject | None:
        """Return the object that a ray has hit; None for no hit, or if the object has been removed since."""
        solid = int(self.hit[ray])
        return None if solid < 0 else self._rays.object_at(self.sight.nodes[solid])

    def segments(self) -> NDArray[np.float32]:
        """Return (N, 7) origin, end (m, world frame) and 1 for a hit, 0 for no hit."""
        position, turn = self.frame()
        turn = turn.T
        result = np.empty((len(self), 7), dtype=np.float32)
        origins = np.zeros((len(self), 3)) if self.origins is None else self.origins
        result[:, 0:3] = matmul(origins, turn) + position
        reach = self.ranges if np.isfinite(self.reach) else np.where(self.hit >= 0, self.distances, 0.0)
        result[:, 3:6] = matmul(origins + self.directions * reach[:, None], turn) + position
        result[:, 6] = self.hit >= 0
        return result
