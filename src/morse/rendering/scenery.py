"""The meshes of a scene as arrays, and their poses at a tick: all that is drawn, without the world."""

from __future__ import annotations

import zlib
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from morse.kernel.drawing.arrays import DITHERED, MASKED, MOVES, Poses
from morse.mathutils.portable import matmul
from morse.rendering.lens import moved
from morse.rendering.meshes import spheres_around

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from morse.kernel.drawing.arrays import Drawing

#: coordinates of vertices beyond which a deformable body has diverged, m
_FARTHEST = 1e7
#: the cyclic order of axes
_NEXT, _AFTER = [1, 2, 0], [2, 0, 1]


#: the arrays of a drawing without colours and textures
_SHAPES = ("vertices", "triangles", "clusters", "spheres", "parts", "closed", "guards", "levels")


class Frames(NamedTuple):
    """The poses of the groups of a world at a tick.

    Attributes:
        positions, rotations: (K, 3) m and (K, 3, 3), frames of the groups in the world.
        offsets: (I, 3, 4) mesh to group.
        visible: (I,) whether each instance is visible.
        velocities: (K, 3) m/s and (K, 3) rad/s, world axes; None if they are not needed.
    """

    positions: NDArray[np.float64]
    rotations: NDArray[np.float64]
    offsets: NDArray[np.float64]
    visible: NDArray[np.bool_]
    velocities: tuple[NDArray[np.float64], NDArray[np.float64]] | None


class Flex(NamedTuple):
    """A deformable body in a drawing.

    Attributes:
        group: that of its instance.
        vertices, clusters: where its vertices and clusters are in the drawing.
        numbers: (N,) the vertex of the mesh that each vertex in the drawing is.
        followed: (V,) the group that each vertex of the mesh follows.
        offsets: (V, 3) from that group to the vertex, world axes, m.
        triangles: (T, 3) vertices of the mesh.
        uvs: (V, 2) texture coordinates.
    """

    group: int
    vertices: slice
    clusters: slice
    numbers: NDArray[np.intp]
    followed: NDArray[np.intp]
    offsets: NDArray[np.float64]
    triangles: NDArray[np.int32]
    uvs: NDArray[np.float32]

    def points(self, positions: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return its vertices (V, 3) in the world, m, at the positions of the groups."""
        return positions[self.followed] + self.offsets

    def origin(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the origin (3,) of the instance.

        It is another one for any other shape, because images and shadows are kept while no instance has moved.
        """
        return np.asarray(points.mean(axis=0)) + 1e-3 * zlib.crc32(np.ascontiguousarray(points).data) / 2**32

    def shape(self, drawing: Drawing, points: NDArray[np.float64]) -> None:
        """Move its vertices in the drawing.

        Args:
            points: (V, 3) relative to the origin, m.
        """
        points = np.where(np.abs(points) < _FARTHEST, points, 0.0)
        corners = points[self.triangles]
        faces = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        normals = np.zeros_like(points)
        for corner in range(3):
            np.add.at(normals, self.triangles[:, corner], faces)
        normals /= np.maximum(np.sqrt((normals**2).sum(axis=1, keepdims=True)), 1e-30)
        vertices = drawing.vertices[self.vertices]
        vertices["p"], vertices["n"] = points[self.numbers], normals[self.numbers]
        vertices["uv"] = self.uvs[self.numbers]
        firsts = drawing.clusters[self.clusters, 0] - self.vertices.start
        drawing.spheres[self.clusters] = spheres_around(vertices["p"], firsts)
        drawing.guards[self.clusters] = drawing.spheres[self.clusters, 3]
        # all levels of detail have one sphere
        whole = spheres_around(vertices["p"], np.zeros(min(len(firsts), 1), np.intp))
        drawing.levels[self.clusters, :4] = whole


class Scenery:
    """The instances of meshes in a scene; it can be pickled.

    Attributes:
        flexes: the deformable bodies, whose clusters are the last ones.
        drawing: their triangles and surfaces.
        groups: (I,) the group of each instance, whose pose `Frames` contains.
        placed: (I, 3, 4) mesh to world, at the poses of the scene.
        finest: (P,) whether each part of the drawing belongs to the finest level of detail, which casts the shadows.
        moving: (P,) whether it also may move.
    """

    def __init__(
        self, drawing: Drawing, groups: NDArray[np.intp], placed: NDArray[np.float64], flexes: Sequence[Flex] = ()
    ) -> None:
        self.drawing, self.groups, self.placed, self.flexes = drawing, groups, placed, flexes
        self.finest = drawing.levels[drawing.parts[:, 0], 4] == 0.0
        self.moving = (drawing.parts[:, 3] & MOVES != 0) & self.finest
        count = len(groups)
        #: the frames and poses of the last call of `poses`: most instances stand still
        self._posed: tuple[Frames | None, Poses] = (
            None,
            Poses(np.zeros((count, 12), np.float32), np.zeros((count, 9), np.float32)),
        )

    def __reduce__(self) -> tuple[object, ...]:
        return Scenery, (self.drawing, self.groups, self.placed, self.flexes)

    def casts_as(self, other: Scenery) -> bool:
        """Whether both cast the same shadows at the same poses: only colours, and textures without holes, differ."""
        own, others = self.drawing, other.drawing
        return (
            all(np.array_equal(getattr(own, name), getattr(others, name)) for name in _SHAPES)
            and np.array_equal(self.groups, other.groups)
            and np.array_equal(self.placed, other.placed)
            and all(map(np.array_equal, _holes(own), _holes(others)))
        )

    def poses(self, frames: Frames, time: float = 0.0) -> Poses:
        """Return the poses of all instances, and move the vertices of deformable bodies; invisible ones get zeros.

        Args:
            frames: the poses of the groups; with velocities if ``time`` is not 0.
            time: s, relative to the time of ``frames``; the velocities are assumed to be constant.
        """
        positions, rotations = frames.positions, frames.rotations
        if time:
            assert frames.velocities is not None
            positions, rotations = moved(positions, rotations, *frames.velocities, time)
        for flex in self.flexes:
            points = flex.points(positions)
            origin = flex.origin(points)
            flex.shape(self.drawing, points - origin)
            if positions is frames.positions:
                positions = positions.copy()
            positions[flex.group] = origin
        frames = frames._replace(positions=positions, rotations=rotations)
        before, poses = self._posed
        rows = self._changed(before, frames)
        if len(rows):
            poses = Poses(poses.models.copy(), poses.turns.copy())
            poses.models[rows], poses.turns[rows] = _placed(frames, rows, self.groups[rows])
        self._posed = frames, poses
        return poses

    def _changed(self, before: Frames | None, now: Frames) -> NDArray[np.intp]:
        """The instances whose poses are not those of other frames."""
        if before is None or len(before.positions) != len(now.positions):
            return np.arange(len(self.groups))
        rotation_changed = (before.rotations != now.rotations).any(axis=(1, 2))
        other = (rotation_changed | (before.positions != now.positions).any(axis=1))[self.groups]
        other |= before.visible != now.visible
        if before.offsets is not now.offsets:
            other |= (before.offsets != now.offsets).any(axis=(1, 2))
        return np.flatnonzero(other)


def _placed(
    frames: Frames, rows: NDArray[np.intp], groups: NDArray[np.intp]
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """The poses (N, 12) and (N, 9) of some instances, see `Poses`."""
    model = matmul(frames.rotations[groups], frames.offsets[rows])
    model[:, :, 3] += frames.positions[groups]
    is_visible = frames.visible[rows] & (np.abs(model) < 1e7).all(axis=(1, 2))
    model[~is_visible] = 0.0
    linear = model[:, :, :3]
    # cofactors are the inverse transposed times the determinant, whose sign is correct for mirrored meshes
    one, other = linear[:, _NEXT], linear[:, _AFTER]
    turns = one[:, :, _NEXT] * other[:, :, _AFTER] - one[:, :, _AFTER] * other[:, :, _NEXT]
    turns *= np.sign(np.einsum("ni,ni->n", turns[:, 0], linear[:, 0]))[:, None, None]
    return model.reshape(-1, 12).astype(np.float32), turns.reshape(-1, 9).astype(np.float32)


def _holes(drawing: Drawing) -> tuple[NDArray[np.int32], NDArray[np.void]]:
    """(S,) the flags of the material of each slot; and the materials of the slots that have holes."""
    materials = drawing.materials[drawing.slots]
    return materials["flags"], materials[materials["flags"] & (MASKED | DITHERED) != 0]
