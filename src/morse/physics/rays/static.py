"""The solids that stand still: triangles that are made once."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from morse.physics.rays.boxes import Boxes
from morse.physics.rays.embree import TriangleScene, single
from morse.physics.rays.solids import BOX, MESH
from morse.physics.rays.sweep import margins, sweep
from morse.physics.rays.triangles import BOX_CORNERS, BOX_TRIANGLES, Triangles, on_plane

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from morse.physics.rays.batch import Batch
    from morse.physics.rays.narrow import Narrow

#: sine of the angle to a plane from which on rounding errors move the point on it by more than a thousandfold
_GRAZING = 1e-3


class StaticScene:
    """Boxes and meshes as what they are, round solids by the boxes around them.

    Args:
        members: the solids that stand still.
        grain: share of a coordinate by which single precision may be wrong.

    Attributes:
        extent: how far from the anchor it reaches along an axis, metres.
    """

    def __init__(self, narrow: Narrow, members: NDArray[np.intp], grain: float) -> None:
        solids = narrow.solids
        self._narrow = narrow
        reach = np.abs(narrow.positions[members]).max(axis=1) + solids.halves[members].max(axis=1)
        grain *= float(reach.max(initial=0.0))
        parts: list[Triangles] = []
        solid_of: list[NDArray[np.intp]] = []
        for solid in members.tolist():
            part = _in_world(narrow, solid, grain)
            parts.append(part)
            solid_of.append(np.full(len(part.faces), solid, dtype=np.intp))
        self._solid_of = np.concatenate([*solid_of, np.empty(0, dtype=np.intp)])
        self._round = np.isin(solids.kinds, (BOX, MESH), invert=True)[self._solid_of]
        self._is_exact = not self._round.any()
        is_exact = np.isin(solids.kinds[members], (BOX, MESH))
        self._boxes = Boxes(narrow, members[~is_exact], grain)
        self._exact = frozenset(members[is_exact].tolist())
        self._groups = set(solids.owners[members].tolist())
        self.extent = 0.0
        if not len(self._solid_of):
            return
        firsts = np.cumsum([0, *(len(part.vertices) for part in parts)])
        vertices = np.concatenate([part.vertices for part in parts])
        faces = np.concatenate([part.faces + first for part, first in zip(parts, firsts, strict=False)])
        self._normals = np.concatenate([part.normals for part in parts])
        self._normal_columns = np.ascontiguousarray(self._normals.T)
        self._offsets = np.concatenate([part.offsets for part in parts])
        self._remissions = np.concatenate([part.remissions for part in parts])
        self.extent = float(np.nanmax(np.abs(vertices)))
        self._scene = TriangleScene(vertices, faces.astype(np.int32))

    def cast(self, batch: Batch, grain: float) -> None:
        """Find what each ray meets first."""
        if not len(self._solid_of):
            return
        usual = batch.groups is self._narrow.solids.owners
        owned = not usual or not self._groups.isdisjoint(batch.owners.tolist())
        if owned or not self._is_exact:
            self._batch = batch
            self._boxes.look_around(batch)
            sweep(self._scene, self._solid_of, self._resolve, batch, grain, owned=owned)
            return
        faces = self._scene.first(*batch.singles, single(batch.distances + grain))
        a, b, c = self._normal_columns.take(faces, axis=1)
        (x, y, z), (u, v, w) = batch.columns
        slopes = a * u + b * v + c * w
        distances = (self._offsets.take(faces) - (a * x + b * y + c * z)) / slopes
        grazing = np.flatnonzero(np.abs(slopes) < _GRAZING)
        if len(grazing):
            distances[grazing] = self._graze(batch, grazing, grain)
        distances[faces < 0] = np.inf
        met = distances < batch.distances
        np.copyto(batch.distances, distances, where=met)
        np.copyto(batch.solids, self._solid_of.take(faces), where=met)
        np.copyto(batch.faces, faces, where=met)

    def _graze(self, batch: Batch, rays: NDArray[np.intp], grain: float) -> NDArray[np.float64]:
        """Distances (K,) of rays that may meet the plane of a triangle far from the triangle."""
        origins, directions = (single(part.take(rays, axis=0)) for part in batch.singles)
        faces, rough = self._scene.cast(origins, directions, single(batch.distances.take(rays) + grain))
        chosen = batch.origins.take(rays, axis=0), batch.directions.take(rays, axis=0)
        return on_plane(faces, rough, self._normals, self._offsets, *chosen)

    def normal(self, solid: int, face: int) -> NDArray[np.float64] | None:
        """Unit normal (3,), world axes, of a triangle, if it is the surface of a solid that stands still."""
        return np.asarray(self._normals[face]) if solid in self._exact else None

    def remissions(self, solid: int, faces: NDArray[np.int32]) -> NDArray[np.float64] | None:
        """(K,) of triangles, if they are the surface of a solid that stands still."""
        return self._remissions[faces] if solid in self._exact else None

    def _resolve(
        self, rays: NDArray[np.intp], faces: NDArray[np.int32], rough: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
        batch = self._batch
        origins, directions = batch.origins.take(rays, axis=0), batch.directions.take(rays, axis=0)
        distances = on_plane(faces, rough, self._normals, self._offsets, origins, directions)
        if not self._is_exact:
            curved = np.flatnonzero(self._round.take(faces))
            solids = self._solid_of.take(faces.take(curved))
            distances[curved], _ = self._narrow.first_surface(batch, rays.take(curved), solids)
        return distances, faces


def _in_world(narrow: Narrow, solid: int, grain: float) -> Triangles:
    solids, mesh = narrow.solids, narrow.solids.meshes[solid]
    position, rotation = narrow.positions[solid], narrow.rotations[solid]
    if mesh is not None:
        return Triangles(mesh.vertices @ rotation.T + position, mesh.faces, mesh.remissions)
    margin = 0.0 if solids.kinds[solid] == BOX else float(margins(np.array([solid]), grain)[0])
    corners = BOX_CORNERS * (solids.halves[solid] + margin)
    remissions = np.full(len(BOX_TRIANGLES), solids.remissions[solid])
    return Triangles(corners @ rotation.T + position, BOX_TRIANGLES, remissions)
