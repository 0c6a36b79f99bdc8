"""The lamps and the sky of a scene, and their shadows."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from morse.kernel.drawing.arrays import (
    CAMERA,
    HEMISPHERE,
    LAMP,
    NO_SURFACE,
    POINT,
    SPOT,
    SUN,
    Light,
    Poses,
    bounds_for,
    changes_for,
)
from morse.mathutils.portable import matmul, norm
from morse.rendering.textures import LINEAR

if TYPE_CHECKING:
    from collections.abc import Sequence
    from typing import Protocol

    from numpy.typing import ArrayLike, NDArray

    from morse.kernel.drawing.arrays import Pictures
    from morse.physics import World
    from morse.rendering.scenery import Scenery
    from morse.scene import Node, Scene, Settings, ViewSettings

    class Drawer(Protocol):
        """Renders images; see `morse.kernel.drawing`."""

        def draw(self, cameras: NDArray[np.void], poses: Poses, light: Light, samples: int) -> Pictures:
            """The images of cameras."""

        def bound_shadows(self, light: Light) -> None:
            """Set the bounds of the map."""

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


#: scale for which a white surface, lit perpendicularly by a lamp of energy 1, has full brightness
_FULL = math.pi
#: factor of the falloff, fitted to lamps whose intensity is half at their distance
_DECAY = 0.3
#: half of the opening angle of an area lamp, rad
_AREA = 1.5
#: direction to the sun in a scene without lamps
_TOWARDS_SUN = (0.45, -0.55, 0.75)
#: maximum number of lamps; the strongest ones are used, as in the live view
_MOST_LAMPS = 8
#: half of the opening angle of a spot, rad, up to which it casts shadows
_WIDEST_SHADOW = 1.05


def _srgb(code: int) -> NDArray[np.float64]:
    return np.asarray(LINEAR[[(code >> shift) & 255 for shift in (16, 8, 0)]], dtype=np.float64)


class Lamps(NamedTuple):
    """The lamps of a scene.

    Attributes:
        lamps: (L,) `LAMP`.
        sunny: (3,) unit vector to the sun that casts shadows.
        spot: the spot lamp that casts shadows, the strongest one; None if there is none.
    """

    lamps: NDArray[np.void]
    sunny: NDArray[np.float64]
    spot: Spot | None


class Spot(NamedTuple):
    """A spot lamp.

    Attributes:
        position: (3,) m, frame of the world.
        rotation: (9,) row by row; it shines along its -Z axis.
        angle: half of the opening angle, rad.
    """

    position: tuple[float, ...]
    rotation: tuple[float, ...]
    angle: float


def light_nodes(scene: Scene) -> list[Node]:
    """The nodes of all lamps."""
    return [node for node in scene.nodes() if node.light is not None]


def lamps_of(all_nodes: Sequence[Node], world: World) -> Lamps:
    """The lamps of a world at their present poses."""
    view, as_in_1_4 = world.scene.settings.view, world.scene.settings.physics_of_1_4
    nodes = [node for node in all_nodes if world.object_of(node).visible]
    suns = [node for node in nodes if node.light is not None and node.light.type == "SUN"]
    mixed = bool(suns) and len(suns) < len(nodes) and not as_in_1_4
    rows: list[tuple[object, ...]] = []
    sunny, spot = None, None
    for node in _strongest_first(nodes, world, view)[:_MOST_LAMPS]:
        light = node.light
        assert light is not None
        position, rotation = world.object_of(node).world_pose()
        towards, color = np.array(rotation[2::3]), np.array(light.color)
        if light.type == "SUN" and sunny is None:
            sunny = towards
            share = 1.0 if as_in_1_4 else 0.85 * (1.5 if mixed else 1.0)
            strength = _FULL * light.energy * share * view.daylight
            rows.append(_lamp(SUN, (0, 0, 0), towards, color * strength, shape=(1.0, 0.0)))
        elif light.type == "SUN":
            rows.append(_lamp(SUN, (0, 0, 0), towards, color * _FULL * light.energy * view.daylight))
        elif light.type == "HEMI":
            half = _FULL * light.energy * 0.5 * view.daylight
            rows.append(_lamp(HEMISPHERE, (0, 0, 0), towards, color * half, ground=np.full(3, 0.051 * half)))
        else:
            decay = max(light.distance, 1e-3) if as_in_1_4 else _DECAY
            share = 1.0 if as_in_1_4 else 0.5 * (0.7 if mixed else 1.0) * max(light.distance, 0.0) ** _DECAY
            is_area = light.type == "AREA"
            angle, edge = (_AREA, 1.0) if is_area else (min(max(light.spot_size / 2, 1e-3), 1.5), 0.3)
            kind = SPOT if is_area or light.type == "SPOT" else POINT
            shape = (math.cos(angle), math.cos(angle * (1 - edge)))
            casts = light.type == "SPOT" and light.casts_shadow and angle <= _WIDEST_SHADOW and spot is None
            if casts:
                spot = Spot(tuple(position), tuple(rotation), angle)
            strength = _FULL * light.energy * share
            ground = (float(casts), 0.0, 0.0)
            rows.append(_lamp(kind, position, towards, color * strength, shape=shape, ground=ground, decay=decay))
    has_sun = sunny is not None
    if sunny is None:
        sunny = np.array(_TOWARDS_SUN) / norm(_TOWARDS_SUN)
    if not has_sun and not (as_in_1_4 and nodes):
        # with lamps in the scene, the sun is faint
        strength = _FULL * (0.35 if nodes else 0.95) * 0.85 * view.daylight
        rows.append(_lamp(SUN, (0, 0, 0), sunny, _srgb(0xFFF3E2) * strength, shape=(1.0, 0.0)))
    if not (as_in_1_4 and nodes):
        rows.append(_sky_light(view, bool(nodes), mixed))
    lamps = np.array(rows, dtype=LAMP)
    for name in LAMP.names or ():
        lamps[name] = np.nan_to_num(lamps[name], nan=0.0, posinf=1e6, neginf=-1e6)
    return Lamps(lamps, sunny, spot)


def _sky_light(view: ViewSettings, lit: bool, mixed: bool) -> tuple[object, ...]:
    above, below = _srgb(0xDFEEFF), _srgb(0xB9AEA0)
    if view.ambient_color:
        above = (above + np.array(view.ambient_color)) / 2
    strength = _FULL * (0.5 if lit else 0.62) * (0.65 if mixed else 1.0) * view.daylight
    return _lamp(HEMISPHERE, (0, 0, 0), (0, 0, 1), above * strength, ground=below * strength)


def sky_of(settings: Settings, sunny: NDArray[np.float64]) -> NDArray[np.float32]:
    """(20,) float32, see `morse.kernel.drawing.arrays.Light`."""
    view = settings.view
    horizon, zenith, nadir, glow = _srgb(0xF4F8FB), _srgb(0x6EA6DE), _srgb(0xC3CAD0), _srgb(0xFFF1D6)
    if view.horizon_color:
        horizon = np.array(view.horizon_color, dtype=np.float64)
        zenith, nadir, glow = horizon * 0.55, horizon * 0.7, glow * 0.3
    horizon, zenith, nadir, glow = (colour * view.daylight for colour in (horizon, zenith, nadir, glow))
    mist = (0.0, 0.0)
    if view.mist is not None and view.mist.enabled:
        mist = (view.mist.start, max(view.mist.depth, 1e-3))
    return np.concatenate([horizon, zenith, nadir, glow, sunny, mist, [settings.physics_of_1_4, 0, 0]]).astype(
        np.float32
    )


def _strongest_first(nodes: Sequence[Node], world: World, view: ViewSettings) -> list[Node]:
    """Sort lamps by their light at the initial viewpoint, as in the live view."""

    def given(node: Node) -> float:
        light = node.light
        assert light is not None
        if light.type in ("SUN", "HEMI"):
            return light.energy
        apart = math.dist(world.object_of(node).world_pose()[0], view.camera_location)
        return light.energy / (1 + (apart / max(light.distance, 0.01)) ** 2)  # the square of a distance may overflow

    return sorted(nodes, key=lambda node: -given(node))


def _lamp(
    kind: int,
    place: ArrayLike,
    towards: ArrayLike,
    color: ArrayLike,
    shape: tuple[float, float] = (0.0, 0.0),
    ground: ArrayLike = (0.0, 0.0, 0.0),
    decay: float = _DECAY,
) -> tuple[object, ...]:
    """A row of `LAMP`; for a sun, ``shape`` is whether it casts shadows, for a spot, the range of its edge."""
    return (
        kind,
        tuple(np.asarray(place)),
        tuple(np.asarray(towards)),
        tuple(np.asarray(color)),
        decay,
        *shape,
        tuple(np.asarray(ground)),
    )


# The shadows of a spot lamp: a depth image from the lamp.

#: texels along a side, and texels outside the cone on each side
_SPOT_SIZE, _SPOT_BORDER = 512, 4
#: m: surfaces that are nearer, such as the housing of the lamp, and surfaces that are farther cast no shadow
_SPOT_NEAR, _SPOT_FAR = 0.2, 200.0


class SpotShadows:
    """The shadow map of a spot lamp; it is rendered again if the lamp or a surface has moved."""

    def __init__(self) -> None:
        self._of: tuple[Spot, NDArray[np.float32]] | None = None
        self._frame = self._map = np.zeros(0, np.float32)
        self._bounds: NDArray[np.float32] | None = None

    def update(self, light: Light, spot: Spot | None, poses: Poses, drawer: Drawer) -> Light:
        """Return the lamps with the shadows of the spot lamp at the present poses."""
        if spot is None or not np.isfinite((*spot.position, *spot.rotation)).all():
            return light._replace(lamp_frame=None, lamp_shadow=None, lamp_bounds=None)
        if self._of is None or self._of[0] != spot or not np.array_equal(self._of[1], poses.models):
            self._render(light, spot, poses, drawer)
            self._of = spot, poses.models
        return light._replace(lamp_frame=self._frame, lamp_shadow=self._map, lamp_bounds=self._bounds)

    def _render(self, light: Light, spot: Spot, poses: Poses, drawer: Drawer) -> None:
        # its axes: right, down, and forward, which is -Z
        axes = np.reshape(spot.rotation, (3, 3)).T * np.array([[1.0], [-1.0], [-1.0]])
        focal = (_SPOT_SIZE / 2 - _SPOT_BORDER) / math.tan(spot.angle)
        camera = np.zeros(1, CAMERA)
        camera["fx"] = camera["fy"] = focal
        camera["cx"] = camera["cy"] = _SPOT_SIZE / 2
        camera["width"] = camera["height"] = _SPOT_SIZE
        camera["near"], camera["far"] = _SPOT_NEAR, _SPOT_FAR
        camera["axes"], camera["eye"], camera["exposure"] = axes.ravel(), spot.position, 1.0
        depth = drawer.draw(camera, poses, light, 1).depth.reshape(_SPOT_SIZE, _SPOT_SIZE)
        self._map = np.where(depth > 0.0, -depth, np.float32(NO_SURFACE)).astype(np.float32)
        self._bounds = bounds_for(self._map)
        drawer.bound_shadows(light._replace(shadow=self._map, shadow_bounds=self._bounds))
        matrix = matmul(np.array([[focal, 0, _SPOT_SIZE / 2], [0, focal, _SPOT_SIZE / 2], [0, 0, 1]]), axes)
        frame = np.zeros(16)
        frame[:12] = np.column_stack([matrix, matmul(-matrix, np.array(spot.position))]).ravel()
        frame[12] = 1 / focal
        self._frame = frame.astype(np.float32)


# The shadows of the sun.

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
