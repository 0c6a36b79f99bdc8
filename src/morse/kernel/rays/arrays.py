"""Solids and rays as arrays."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

#: indices of the kinds of shapes in arrays
BOX, SPHERE, CYLINDER, CAPSULE, ELLIPSOID, MESH = range(6)


@dataclass(eq=False)
class TriangleMesh:
    """Triangles in their own frame.

    Attributes:
        vertices: (V, 3) metres.
        faces: (T, 3) indices of vertices.
    """

    vertices: NDArray[np.float64]
    faces: NDArray[np.int32]

    def corners(self) -> NDArray[np.float64]:
        """(T, 3, 3) triangle, corner, axis."""
        return np.ascontiguousarray(self.vertices[self.faces], dtype=np.float64)


class Poses(NamedTuple):
    """The poses of the rigid groups.

    Attributes:
        positions: (K, 3) metres, world frame.
        rotations: (K, 3, 3) from each group to the world.
        anchor: (3,) metres: hits are computed relative to this position.
    """

    positions: NDArray[np.float64]
    rotations: NDArray[np.float64]
    anchor: NDArray[np.float64]


class SolidArrays:
    """Solids, one row each.

    Attributes:
        kinds: (S,) `BOX` to `MESH`.
        sizes: (S, 3) of primitives.
        slots: (S,) the rigid group of each solid.
        places, turns: (S, 3) metres and (S, 3, 3), the pose in the group.
        centres, halves: (S, 3) metres, the box around each, in its own frame.
        meshes: [S] the triangles, None for primitives.
    """

    def __init__(
        self,
        kinds: NDArray[np.integer],
        sizes: NDArray[np.float64],
        slots: NDArray[np.integer],
        places: NDArray[np.float64],
        turns: NDArray[np.float64],
        centres: NDArray[np.float64],
        halves: NDArray[np.float64],
        meshes: Sequence[TriangleMesh | None],
    ) -> None:
        count = len(kinds)
        self.kinds = np.ascontiguousarray(kinds, dtype=np.int32)
        self.sizes = _rows(sizes, (count, 3))
        self.slots = np.ascontiguousarray(slots, dtype=np.int64)
        self.places, self.turns = _rows(places, (count, 3)), _rows(turns, (count, 3, 3))
        self.centres, self.halves = _rows(centres, (count, 3)), _rows(halves, (count, 3))
        self.meshes = list(meshes)
        if len(self.slots) != count or len(self.meshes) != count:
            raise ValueError(f"{count} kinds, but {len(self.slots)} slots and {len(self.meshes)} meshes")

    def __len__(self) -> int:
        return len(self.kinds)


class Fan:
    """The rays of some sensors with the same directions.

    Attributes:
        slots: (B,) the rigid group of each sensor.
        offsets, turns: (B, 3) metres and (B, 3, 3), the pose of each sensor in its group.
        directions: (N, 3) unit vectors in the frame of the sensor.
        origins: (N, 3) metres in the frame of the sensor, None for its origin.
        upright: directions and origins are in the axes of the world.
        limit: maximum distance, metres.
        owners: (B,) the group of solids that the rays of each sensor pass through.
    """

    def __init__(
        self,
        slots: NDArray[np.integer] | Sequence[int],
        offsets: NDArray[np.float64],
        turns: NDArray[np.float64],
        directions: NDArray[np.float64],
        origins: NDArray[np.float64] | None,
        upright: bool,
        limit: float,
        owners: NDArray[np.integer] | Sequence[int],
    ) -> None:
        self.slots = np.ascontiguousarray(slots, dtype=np.int64)
        count, rays = len(self.slots), len(directions)
        self.offsets, self.turns = _rows(offsets, (count, 3)), _rows(turns, (count, 3, 3))
        self.directions = _rows(directions, (rays, 3))
        self.origins = None if origins is None else _rows(origins, (rays, 3))
        self.upright, self.limit = upright, float(limit)
        self.owners = np.ascontiguousarray(owners, dtype=np.int64)
        if len(self.owners) != count:
            raise ValueError(f"{count} sensors, but {len(self.owners)} owners")

    @property
    def shape(self) -> tuple[int, int]:
        """Number of sensors, and of rays of each."""
        return len(self.slots), len(self.directions)


class Hits(NamedTuple):
    """The hits of rays.

    Attributes:
        distances: (B, N) metres, infinite without a hit.
        solids: (B, N) index of the solid, -1 without a hit.
        faces: (B, N) triangle of its mesh, -1 for primitives and without a hit.
    """

    distances: NDArray[np.float64]
    solids: NDArray[np.int64]
    faces: NDArray[np.int32]

    @classmethod
    def empty(cls, shape: tuple[int, int]) -> Hits:
        """Uninitialised hits of some shape."""
        return cls(np.empty(shape), np.empty(shape, dtype=np.int64), np.empty(shape, dtype=np.int32))

    def rows(self, rows: NDArray[np.int64] | slice) -> Hits:
        """The hits of some sensors: views for a slice, else copies."""
        return Hits(self.distances[rows], self.solids[rows], self.faces[rows])

    @classmethod
    def nothing(cls, shape: tuple[int, int]) -> Hits:
        """Rays without a hit."""
        return cls(np.full(shape, np.inf), np.full(shape, -1, dtype=np.int64), np.full(shape, -1, dtype=np.int32))


def _rows(values: NDArray[np.float64], shape: tuple[int, ...]) -> NDArray[np.float64]:
    rows = np.ascontiguousarray(values, dtype=np.float64)
    if rows.shape != shape:
        raise ValueError(f"an array of the shape {shape} is needed, given {rows.shape}")
    return rows
