"""The meshes of a scene as arrays, and their poses at a tick: all that is drawn, without the world."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from morse.kernel.drawing.arrays import DITHERED, MASKED, MOVES, Poses
from morse.mathutils.portable import matmul
from morse.rendering.lens import moved

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from morse.kernel.drawing.arrays import Drawing

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


class Scenery:
    """The instances of meshes in a scene; it can be pickled.

    Attributes:
        drawing: their triangles and surfaces.
        groups: (I,) the group of each instance, whose pose `Frames` contains.
        placed: (I, 3, 4) mesh to world, at the poses of the scene.
        finest: (P,) whether each part of the drawing belongs to the finest level of detail, which casts the shadows.
        moving: (P,) whether it also may move.
    """

    def __init__(self, drawing: Drawing, groups: NDArray[np.intp], placed: NDArray[np.float64]) -> None:
        self.drawing, self.groups, self.placed = drawing, groups, placed
        self.finest = drawing.levels[drawing.parts[:, 0], 4] == 0.0
        self.moving = (drawing.parts[:, 3] & MOVES != 0) & self.finest
        count = len(groups)
        #: the frames and poses of the last call of `poses`: most instances stand still
        self._posed: tuple[Frames | None, Poses] = (
            None,
            Poses(np.zeros((count, 12), np.float32), np.zeros((count, 9), np.float32)),
        )

    def __reduce__(self) -> tuple[object, ...]:
        return Scenery, (self.drawing, self.groups, self.placed)

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
        """Return the poses of all instances; invisible instances get zeros.

        Args:
            frames: the poses of the groups; with velocities if ``time`` is not 0.
            time: s, relative to the time of ``frames``; the velocities are assumed to be constant.
        """
        positions, rotations = frames.positions, frames.rotations
        if time:
            assert frames.velocities is not None
            positions, rotations = moved(positions, rotations, *frames.velocities, time)
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
