"""The rays of one sensor."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Protocol

import numpy as np

from morse.kernel.rays.arrays import Hits

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike, NDArray

    from morse.physics.gameobject import GameObject
    from morse.physics.rays.solids import Solids
    from morse.scene import Node


#: distances beyond it would overflow single precision
_FARTHEST = 1e30


def farther(reach: float) -> float:
    """The next number after a reach, m: what is just as far as that is within reach."""
    return math.nextafter(min(reach, _FARTHEST), math.inf)


class Scan:
    """What the rays of one or more bundles of the same shape have met, one row a bundle.

    Attributes:
        distances: (B, N) metres, infinite for none.
        solids: (B, N) index of the solid, -1 for none.
        faces: (B, N) triangle of the mesh of the solid, -1 for others.
        known: what these numbers mean; None before the first cast.
    """

    __slots__ = ("_directions", "_origins", "_points", "_ranges", "_reach", "distances", "faces", "known", "solids")

    def __init__(self, bundle: RayBundle, hits: Hits, known: Solids | None = None) -> None:
        self.known = known
        self._directions, self._origins, self._reach = bundle.directions, bundle.origins, bundle.reach
        self.distances, self.solids, self.faces = hits
        self._points: NDArray[np.float64] | None = None
        self._ranges: NDArray[np.float64] | None = None

    def ranges(self) -> NDArray[np.float64]:
        """(B, N) metres, the reach for none; worked out for all bundles when the first asks."""
        if self._ranges is None:
            self._ranges = np.minimum(self.distances, self._reach)
        return self._ranges

    def points(self) -> NDArray[np.float64]:
        """(B, N, 3) metres in the frame of each sensor, null for none."""
        if self._points is None:
            length = np.where(self.solids >= 0, self.distances, 0.0)[..., None]
            # no -0.0: clients read these numbers
            self._points = self._directions * length + 0.0
            if self._origins is not None:
                self._points += np.where(length > 0.0, self._origins, 0.0)
        return self._points


class Sight:
    """What the rays of one bundle met in one cast; it does not change when they are cast again."""

    __slots__ = ("_row", "_scan")

    def __init__(self, scan: Scan, row: int) -> None:
        self._scan, self._row = scan, row

    @property
    def distances(self) -> NDArray[np.float64]:
        """(N,) metres to what each ray met, infinite for nothing."""
        row: NDArray[np.float64] = self._scan.distances[self._row]
        return row

    @property
    def ranges(self) -> NDArray[np.float64]:
        """(N,) metres to what each ray met, the reach for nothing."""
        row: NDArray[np.float64] = self._scan.ranges()[self._row]
        return row

    @property
    def points(self) -> NDArray[np.float64]:
        """(N, 3) metres, where each ray met something, in the frame of the sensor; [0, 0, 0] for nothing."""
        row: NDArray[np.float64] = self._scan.points()[self._row]
        return row

    @property
    def hit(self) -> NDArray[np.int64]:
        """(N,) number of the solid that each ray met; -1 for nothing."""
        row: NDArray[np.int64] = self._scan.solids[self._row]
        return row

    @property
    def faces(self) -> NDArray[np.int32]:
        """(N,) triangle of the mesh of the solid that each ray met; -1 for others."""
        row: NDArray[np.int32] = self._scan.faces[self._row]
        return row

    @property
    def nodes(self) -> Sequence[Node]:
        """[S] what the numbers of the solids mean."""
        known = self._scan.known
        return known.nodes if known is not None else ()

    @property
    def remissions(self) -> NDArray[np.float64]:
        """(N,) ``specular`` of the material that each ray met; 0 for nothing."""
        known = self._scan.known
        return known.remissions_of(self.hit, self.faces) if known is not None else np.zeros(len(self.hit))


class Casting(Protocol):
    """What bundles need of `Rays`."""

    @property
    def stamp(self) -> int:
        """Changes whenever anything has moved."""

    def cast(self, bundles: Sequence[RayBundle]) -> None:
        """Cast the rays of some sensors."""

    def serve(self, requests: Sequence[RayBundle]) -> None:
        """Cast the bundles that components ask for in a tick."""

    def checked_directions(self, directions: ArrayLike) -> NDArray[np.float64]:
        """Directions (N, 3) as unit vectors."""

    def object_at(self, node: Node) -> GameObject | None:
        """The object of a node, if the node is still in the world."""


class RayBundle:
    """The rays of one sensor, and what they met when they were cast last.

    Attributes:
        obj: the object whose frame the rays are given in; they pass through the robot that it is part of.
        origins: (N, 3) metres in the frame of the object, or None if all rays start at its origin.
        directions: (N, 3) unit vectors in the frame of the object; do not write into the array.
        reach: metres; what is farther away is not seen.
        upright: whether they turn with the object, or are along the axes of the world.
        limit: what is nearer than that is seen.
        sight: what they met.
        stamp: that of the world when the rays were cast last.
    """

    #: a component makes it, and makes it again if it looks elsewhere: the hits are not part of the state
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
        """The object that casts these rays together with those of other sensors (see `morse.core.requests`)."""
        return self._rays

    @property
    def shape(self) -> tuple[int, int, float, bool]:
        """Equal for bundles that can be worked on together."""
        return id(self.directions), id(self.origins), self.reach, self.upright

    def turn_to(self, directions: ArrayLike) -> None:
        """Look into other directions: (N, 3) vectors, not null, in the frame of the object."""
        self.directions = self._rays.checked_directions(directions)
        self.stamp = -1

    def take(self, scan: Scan, row: int, stamp: int) -> None:
        """Take the results of a cast."""
        self.sight, self.stamp = Sight(scan, row), stamp

    def refresh(self) -> None:
        """Cast the rays now, unless they were cast since anything moved."""
        if self.stamp != self._rays.stamp:
            self._rays.cast([self])

    @property
    def distances(self) -> NDArray[np.float64]:
        """(N,) metres to what each ray met, infinite for nothing."""
        return self.sight.distances

    @property
    def ranges(self) -> NDArray[np.float64]:
        """(N,) metres to what each ray met, the reach for nothing."""
        return self.sight.ranges

    @property
    def points(self) -> NDArray[np.float64]:
        """(N, 3) metres, where each ray met something, in the frame of the sensor; [0, 0, 0] for nothing."""
        return self.sight.points

    @property
    def hit(self) -> NDArray[np.int64]:
        """(N,) number of the solid that each ray met, see `object_of`; -1 for nothing."""
        return self.sight.hit

    @property
    def remissions(self) -> NDArray[np.float64]:
        """(N,) how much light comes back, 0..1: the ``specular`` of the material that was met; 0 for nothing."""
        return self.sight.remissions

    def object_of(self, ray: int) -> GameObject | None:
        """The object that a ray met; None if it met nothing, or something that has been removed since."""
        solid = int(self.hit[ray])
        return None if solid < 0 else self._rays.object_at(self.sight.nodes[solid])

    def segments(self) -> NDArray[np.float32]:
        """(N, 7) origin, end (metres, world frame) and 1 where something was hit, 0 elsewhere."""
        position, rotation = self.obj.world_pose()
        turn = np.eye(3) if self.upright else np.reshape(rotation, (3, 3)).T
        result = np.empty((len(self), 7), dtype=np.float32)
        origins = np.zeros((len(self), 3)) if self.origins is None else self.origins
        result[:, 0:3] = origins @ turn + position
        reach = self.ranges if np.isfinite(self.reach) else np.where(self.hit >= 0, self.distances, 0.0)
        result[:, 3:6] = (origins + self.directions * reach[:, None]) @ turn + position
        result[:, 6] = self.hit >= 0
        return result
