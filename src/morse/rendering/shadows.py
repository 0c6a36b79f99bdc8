"""The shadows of the sun."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from morse.kernel.drawing.arrays import NO_SURFACE, Light, Poses, bounds_for, changes_for
from morse.mathutils.portable import matmul, norm

if TYPE_CHECKING:
    from typing import Protocol

    from numpy.typing import NDArray

    from morse.rendering.scenery import Scenery

    class Caster(Protocol):
        """Draws into the map; see `morse.kernel.drawing`."""

        def cast_shadows(self, parts: NDArray[np.integer], poses: Poses, light: Light) -> NDArray[np.int32]:
            """The texels that parts may have filled."""

        def bound_shadows(self, light: Light) -> None:
            """Set the bounds of the map."""

        def moving_shadows(self, parts: NDArray[np.integer], light: Light) -> Movers:
            """The shadows of parts that may move, in a map with the shadows of the others."""

    class Movers(Protocol):
        """The shadows of parts that may move."""

        extents: NDArray[np.int32]

        def update(self, poses: Poses, cameras: NDArray[np.void], left_out: NDArray[np.bool_] | None = None) -> None:
            """Draw the shadows of parts that have moved again, if a camera may see them."""


#: minimum size of a texel, m
_FINEST = 0.02
#: maximum number of texels along the longer side: of a single map, and of the coarse map of two
_MOST, _MOST_COARSE = 4096, 2048
#: margin around the scene in which moving objects cast shadows, m
_AROUND = 5.0
#: margin around moving objects that the fine map covers, m
_NEAR = 10.0
#: texels at the border
_BORDER = 4


class Shadows:
    """The shadows of the sun: a map of the whole scene, and in large scenes a finer one around the initial robot poses.

    The maps are computed from the poses in the scene, so that they do not depend on the time of their creation.

    Args:
        sunny: (3,) unit vector to the sun.

    Attributes:
        light: the lamps with these maps; its lamps may be replaced.
    """

    def __init__(self, scenery: Scenery, drawer: Caster, sunny: NDArray[np.float64], light: Light) -> None:
        self.sunny = sunny
        axes = _axes(sunny)
        low, high = _extent(scenery, axes, scenery.finest, _AROUND)
        frame, shape = _frame(axes, low, high, _MOST)
        self._maps = []
        if scenery.moving.any() and frame[12] > _FINEST:
            around = _extent(scenery, axes, scenery.moving, _NEAR)
            near = _frame(axes, np.maximum(around[0], low), np.minimum(around[1], high), _MOST)
            if near[0][12] < 0.5 * frame[12]:
                self._maps.append(ShadowMap(scenery, drawer, light, *near))
                frame, shape = _frame(axes, low, high, _MOST_COARSE)
        self._maps.append(ShadowMap(scenery, drawer, light, frame, shape))
        self._still = np.unique(scenery.drawing.parts[scenery.finest & ~scenery.moving, 1])
        self._stood = np.zeros((0, 12), np.float32)
        self.light = self._maps[-1].light
        if len(self._maps) > 1:
            finer = self._maps[0].light
            self.light = self.light._replace(
                near_sun=finer.sun,
                near_shadow=finer.shadow,
                near_bounds=finer.shadow_bounds,
                near_changes=finer.shadow_changes,
            )

    def update(self, poses: Poses, cameras: NDArray[np.void]) -> None:
        """Update the shadows of moved objects.

        Args:
            cameras: (K,) `CAMERA`, those for which the maps are used.
        """
        stands = poses.models[self._still]
        if not np.array_equal(stands, self._stood):
            self._stood = stands
            for shadow_map in self._maps:
                shadow_map.begin(poses)
        if len(self._maps) == 1:
            self._maps[0].update(poses, cameras)
            return
        fine, coarse = self._maps
        fine.update(poses, cameras)
        coarse.update(poses, cameras, fine.covers(coarse.light.sun[12] / fine.light.sun[12]))


class ShadowMap:
    """The distances of the nearest surfaces from the sun; only moved objects are rendered again.

    Args:
        frame: (16,) see `Light.sun`.
        shape: rows and columns of texels.

    Attributes:
        light: the light with only this map.
    """

    def __init__(
        self, scenery: Scenery, drawer: Caster, light: Light, frame: NDArray[np.float64], shape: tuple[int, int]
    ) -> None:
        self._drawer = drawer
        shadow = np.full(shape, NO_SURFACE, np.float32)
        self.light = light._replace(
            sun=frame.astype(np.float32),
            shadow=shadow,
            shadow_bounds=bounds_for(shadow),
            shadow_changes=changes_for(shadow),
        )
        moving, still = scenery.moving, scenery.finest & ~scenery.moving
        self._still, self._movers = np.flatnonzero(still), np.flatnonzero(moving)
        self._moving: Movers | None = None

    def covers(self, ratio: float) -> NDArray[np.bool_]:
        """(M,) the moving parts whose shadows another map need not contain, because this one has priority.

        Args:
            ratio: size of the texels of the other map, relative to those of this one.
        """
        assert self.light.shadow is not None
        high, wide = self.light.shadow.shape
        # a point at the border is shifted by 1.3 texels of the other map, and read from 4 x 4 of them
        margin = _BORDER + 5.0 * ratio
        assert self._moving is not None
        rows = self._moving.extents
        return np.asarray(
            (rows[:, :2] > margin).all(axis=1) & (rows[:, 2] < wide - margin) & (rows[:, 3] < high - margin)
        )

    def begin(self, poses: Poses) -> None:
        """Draw the shadows of all objects that do not move."""
        shadow = self.light.shadow
        assert shadow is not None
        shadow[:] = NO_SURFACE
        self._drawer.cast_shadows(self._still, poses, self.light)
        self._drawer.bound_shadows(self.light)
        self._moving = self._drawer.moving_shadows(self._movers, self.light)

    def update(self, poses: Poses, cameras: NDArray[np.void], left_out: NDArray[np.bool_] | None = None) -> None:
        """Update the shadows of moved objects.

        Args:
            cameras: (K,) `CAMERA`.
            left_out: (M,) the moving parts whose shadows are not needed.
        """
        if self._moving is None:
            self.begin(poses)
        assert self._moving is not None
        self._moving.update(poses, cameras, left_out)


def _axes(sunny: NDArray[np.float64]) -> NDArray[np.float64]:
    """(3, 3) rows: two directions perpendicular to the light, and the direction to the sun."""
    right = np.cross(sunny, (0.0, 1.0, 0.0) if abs(sunny[1]) < 0.9 else (1.0, 0.0, 0.0))
    right /= norm(right)
    return np.stack([right, np.cross(sunny, right), sunny])


def _extent(
    scenery: Scenery, axes: NDArray[np.float64], selection: NDArray[np.bool_], around: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Lower and upper corner, along the axes, of a box around some parts at the poses of the scene."""
    parts, spheres = scenery.drawing.parts[selection], scenery.drawing.spheres
    low, high = np.zeros(3), np.zeros(3)
    shape = scenery.placed[parts[:, 1]]
    fine = (np.abs(shape) < 1e6).all(axis=(1, 2))
    if fine.any():
        balls = spheres[parts[fine, 0]].astype(np.float64)
        centres = np.einsum("pij,pj->pi", shape[fine, :, :3], balls[:, :3]) + shape[fine, :, 3]
        reach = (balls[:, 3] * np.linalg.norm(shape[fine, :, :3], axis=(1, 2)))[:, None]
        low, high = (
            (matmul(centres, axes.T) - reach).min(axis=0),
            (matmul(centres, axes.T) + reach).max(axis=0),
        )
    return low - around, high + around


def _frame(
    axes: NDArray[np.float64], low: NDArray[np.float64], high: NDArray[np.float64], most: int
) -> tuple[NDArray[np.float64], tuple[int, int]]:
    """World to texels and metres towards the sun, see `Light`; and the shape of the map."""
    texel = max(float((high - low)[:2].max()) / (most - 2 * _BORDER), _FINEST)
    width, height = (int(size / texel) + 2 * _BORDER for size in (high - low)[:2])
    frame = np.zeros(16)
    frame[:12] = np.column_stack([axes, (_BORDER * texel - low[0], _BORDER * texel - low[1], 0.0)]).ravel()
    frame[:8] /= texel
    frame[12] = texel
    return frame, (height, width)
