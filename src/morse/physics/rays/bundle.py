"""The rays of one sensor."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from morse.physics.rays.leaving import way_out

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from morse.physics.gameobject import GameObject
    from morse.physics.rays.rays import Rays
    from morse.physics.rays.solids import Solids


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
        faces: (B, N) see `Batch`.
    """

    __slots__ = ("_bundle", "_points", "_ranges", "distances", "faces", "solids")

    def __init__(
        self,
        bundle: RayBundle,
        distances: NDArray[np.float64],
        solids: NDArray[np.intp],
        faces: NDArray[np.int32],
    ) -> None:
        self._bundle = bundle
        self.distances, self.solids, self.faces = distances, solids, faces
        self._points: NDArray[np.float64] | None = None
        self._ranges: NDArray[np.float64] | None = None

    def ranges(self) -> NDArray[np.float64]:
        """(B, N) metres, the reach for none; worked out for all bundles when the first asks."""
        if self._ranges is None:
            self._ranges = np.minimum(self.distances, self._bundle.reach)
        return self._ranges

    def points(self) -> NDArray[np.float64]:
        """(B, N, 3) metres in the frame of each sensor, null for none."""
        if self._points is None:
            length = np.where(self.solids >= 0, self.distances, 0.0)[..., None]
            # no -0.0: clients read these numbers
            self._points = self._bundle.directions * length + 0.0
            if self._bundle.origins is not None:
                self._points += np.where(length > 0.0, self._bundle.origins, 0.0)
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
    def hit(self) -> NDArray[np.intp]:
        """(N,) number of the solid that each ray met; -1 for nothing."""
        row: NDArray[np.intp] = self._scan.solids[self._row]
        return row

    @property
    def faces(self) -> NDArray[np.int32]:
        """(N,) see `Batch`."""
        row: NDArray[np.int32] = self._scan.faces[self._row]
        return row

    def range_list(self) -> list[float]:
        """`ranges` as a list."""
        result: list[float] = self.ranges.tolist()
        return result

    def point_list(self) -> list[list[float]]:
        """`points` as lists."""
        result: list[list[float]] = self.points.tolist()
        return result


class RayBundle:
    """The rays of one sensor, and what they met when they were cast last.

    Attributes:
        obj: the object whose frame the rays are given in; they pass through the robot that it is part of.
        origins: (N, 3) metres in the frame of the object, or None if all rays start at its origin.
        directions: (N, 3) unit vectors in the frame of the object; do not write into the array.
        reach: metres; what is farther away is not seen.
        upright: whether they turn with the object, or are along the axes of the world.
        limit: what is nearer than that is seen.
        owner: the group of solids that the rays pass through.
        starts: (N,) metres from which on each ray has left the body that the sensor is mounted on.
        clearance: the largest of these.
        sight: what they met.
        stamp: that of the world when the rays were cast last.
    """

    def __init__(
        self,
        rays: Rays,
        obj: GameObject,
        directions: NDArray[np.float64],
        reach: float,
        origins: NDArray[np.float64] | None,
        owner: int,
        upright: bool,
    ) -> None:
        self._rays = rays
        self.obj = obj
        self.directions = directions
        self.reach, self.limit = reach, farther(reach)
        self.origins = origins
        self.owner = owner
        self.upright = upright
        self.stamp = -1
        self.starts, self.clearance = np.zeros(len(directions)), 0.0
        self._mounting: tuple[Any, ...] = ()
        count = len(directions)
        scan = Scan(self, np.full((1, count), np.inf), np.full((1, count), -1), np.full((1, count), -1, dtype=np.int32))
        self.sight = Sight(scan, 0)

    def __len__(self) -> int:
        return len(self.directions)

    @property
    def shape(self) -> tuple[int, int, float, bool]:
        """Equal for bundles that can be worked on together."""
        return id(self.directions), id(self.origins), self.reach, self.upright

    def mount(self, solids: Solids, grain: float) -> None:
        """Find out where the rays leave what the sensor is mounted on, if that has changed."""
        if self.upright:
            return
        offset = self.obj.offset
        mounting = (solids.arrangement, grain, *offset)
        if self._mounting != mounting:
            self._mounting = mounting
            self.starts = way_out(solids, self.obj.slot, offset, self.directions, self.origins, grain)
            self.clearance = float(self.starts.max())

    def turn_to(self, directions: ArrayLike) -> None:
        """Look into other directions: (N, 3) vectors, not null, in the frame of the object."""
        self.directions = self._rays.checked_directions(directions)
        self._mounting, self.stamp = (), -1

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
    def hit(self) -> NDArray[np.intp]:
        """(N,) number of the solid that each ray met, see `object_of`; -1 for nothing."""
        return self.sight.hit

    @property
    def remissions(self) -> NDArray[np.float64]:
        """(N,) how much light comes back, 0..1: the ``specular`` of the material that was met; 0 for nothing."""
        return self._rays.remissions(self.hit, self.sight.faces)

    def object_of(self, ray: int) -> GameObject | None:
        """The object that a ray met."""
        solid = int(self.hit[ray])
        return None if solid < 0 else self._rays.object_of(solid)

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
