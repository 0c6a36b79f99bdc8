"""The lights of a `mujoco.MjvScene`, with their shadows."""

from __future__ import annotations

import math
from itertools import count
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from morse.eyes.shadows import MapMaker
from morse.kernel.drawing.arrays import (
    CLASSIC,
    CLASSIC_LIGHT,
    HEMISPHERE,
    LAMP,
    MOST_SHADOWS,
    NO_SURFACE,
    POINT,
    SPOT,
    SUN,
    Light,
    bounds_for,
)
from morse.kernel.memory import address

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from morse.eyes.shadows import Casters
    from morse.kernel.drawing.arrays import Poses
    from morse.kernel.drawing.native import NativeDrawer

#: kinds of lights in MuJoCo
_SPOT, DIRECTIONAL, POINT_LIGHT, IMAGE = range(4)


class Lit(NamedTuple):
    """A light of a scene.

    Attributes:
        place, towards: (3,) m, and unit vector against its direction.
        ambient, diffuse, specular, attenuation: (3,) see ``light`` in MJCF.
        cutoff: half of the opening angle, rad; pi for all directions.
        exponent: of the fall-off within the angle.
        directional, casts: whether it is infinitely far, and whether it casts shadows.
    """

    place: NDArray[np.float64]
    towards: NDArray[np.float64]
    ambient: NDArray[np.float64]
    diffuse: NDArray[np.float64]
    specular: NDArray[np.float64]
    attenuation: NDArray[np.float64]
    cutoff: float
    exponent: float
    directional: bool
    casts: bool


def lights_of(scene: Any) -> list[Lit]:
    """The lights of a `mujoco.MjvScene` that can be drawn; lights with values that are not finite are left out."""
    lights = []
    for light in scene.lights[: scene.nlight]:
        kind = int(getattr(light, "type", DIRECTIONAL if getattr(light, "directional", 0) else _SPOT))
        if kind == IMAGE:
            continue
        values = np.array(
            (light.pos, light.dir, light.ambient, light.diffuse, light.specular, light.attenuation), np.float64
        )
        place, towards, ambient, diffuse, specular, attenuation = values
        length = math.sqrt(float((towards**2).sum()))
        if not np.isfinite(values).all() or (length < 1e-9 and kind != POINT_LIGHT):
            continue
        directional = bool(light.headlight) or kind == DIRECTIONAL
        cutoff = math.pi if kind == POINT_LIGHT or light.cutoff > 90 else math.radians(light.cutoff)
        lights.append(
            Lit(
                place,
                -towards / max(length, 1e-9),
                ambient,
                diffuse,
                specular,
                attenuation,
                cutoff=cutoff,
                exponent=float(light.exponent),
                directional=directional,
                casts=bool(light.castshadow) and not light.headlight,
            )
        )
    return lights


def without_shadows(lights: list[Lit]) -> list[Lit]:
    """The same lights that cast no shadows: OpenGL adds them up in one pass."""
    return [light._replace(casts=False) for light in lights]


class ShadowMap(NamedTuple):
    """A shadow map.

    Attributes:
        frame: (16,) see ``sun`` and ``lamp_frame`` of `Light`; column and row 0 of the map of a spot are at the numbers
            13 and 14, texels from the position of the light.
        texels: (H, W) see ``shadow`` and ``lamp_shadow`` of `Light`.
        bounds: of its blocks, see `Light`; None for the smallest maps.
        version: another one for each map of this process.
    """

    frame: NDArray[np.float32]
    texels: NDArray[np.float32]
    bounds: NDArray[np.float32] | None
    version: int


_versions = count(1)


def new_version() -> int:
    """The number of a new shadow map."""
    return next(_versions)


class ShadowMaps:
    """The shadow maps of lights; a map is drawn again if its light or a surface has moved.

    Args:
        texels: along the side of a map.
        finest: the same of MuJoCo's own, which are around all that a light shines at.
    """

    def __init__(self, texels: int, finest: int) -> None:
        self._maker = MapMaker(texels, finest)
        self._maps: list[tuple[object, ShadowMap]] = []

    def map_of(
        self,
        number: int,
        light: Lit,
        drawer: NativeDrawer,
        parts: NDArray[np.int32],
        poses: Poses,
        seen: NDArray[np.float64],
        casters: Casters,
        scale: float,
    ) -> ShadowMap | None:
        """Return the map of a light; None if it casts no shadows that are seen.

        Args:
            number: of the map, which is kept.
            parts: (P, 4) the parts that cast shadows.
            seen: (1, 8, 3) corners around the visible surfaces, m.
            casters: of one scene: the map ends around them if they are bounded.
            scale: share of the cone of a light that has shadows; for directional lights, half the width of the map, m.
        """
        around = [casters.middle[casters.casting], casters.reach[casters.casting], casters.bounded, seen]
        key = light.place.tobytes(), light.towards.tobytes(), light.cutoff, scale, *(one.tobytes() for one in around)
        kept = self._maps[number] if number < len(self._maps) else None
        same = (key, parts.tobytes(), poses.models.tobytes())
        if kept is not None and kept[0] == same:
            return kept[1]
        before = drawer.drawing.parts
        drawer.arrange(parts)
        drawn = self._draw(light, drawer, poses, seen, casters, scale)
        drawer.arrange(before)
        if drawn is None:
            return None
        bounds = bounds_for(drawn[1])
        if bounds is not None:
            drawer.bound(drawn[1], bounds)
        made = ShadowMap(*drawn, bounds, new_version())
        self._maps[number : number + 1] = [(same, made)]
        return made

    def _draw(
        self,
        light: Lit,
        drawer: NativeDrawer,
        poses: Poses,
        seen: NDArray[np.float64],
        casters: Casters,
        scale: float,
    ) -> tuple[NDArray[np.float32], NDArray[np.float32]] | None:
        place, towards = light.place[None], light.towards[None]
        if light.directional:
            has, frame, sizes = self._maker.from_afar(place, towards, seen, casters, scale)
            if not has[0]:
                return None
            shadow = np.full(sizes[0, ::-1], NO_SURFACE, np.float32)
            own = NO_LIGHT._replace(sun=frame[0], shadow=shadow)
            drawer.cast_shadows(np.arange(len(drawer.drawing.parts)), poses, own)
            return frame[0], shadow
        has, frame, camera = self._maker.from_near(place, towards, np.array([light.cutoff]), seen, casters, scale)
        if not has[0]:
            return None
        depth = drawer.draw(camera, poses, NO_LIGHT, 1).depth
        shape = int(camera["height"][0]), int(camera["width"][0])
        return frame[0], np.where(depth > 0.0, -depth, np.float32(NO_SURFACE)).reshape(shape)


#: no lamps of scenes
NO_LIGHT = Light(np.zeros(0, LAMP), np.zeros(20, np.float32), np.zeros(16, np.float32), None)


class Surroundings(NamedTuple):
    """What a scene has besides geoms and lights.

    Attributes:
        sky: number of the first of six textures, -1 without.
        haze: (3,) colour; ring: share of the radius; far: m; plane: (4,) normal and offset, None without haze.
        fog: (3,) colour, begin and end, m; None without.
    """

    sky: int
    haze: NDArray[np.float64]
    ring: float
    far: float
    plane: NDArray[np.float64] | None
    fog: tuple[NDArray[np.float64], float, float] | None


def classic(lights: list[Lit], maps: list[ShadowMap | None], around: Surroundings) -> Light:
    """The lights of OpenGL; `maps` are those of each light that casts shadows, if these are seen."""
    rows = np.zeros(len(lights), CLASSIC_LIGHT)
    number = 0
    # of too many lights that cast shadows, those whose shadows are seen come first
    alone = sorted((n for n, light in enumerate(lights) if light.casts), key=lambda n: maps[n] is None)[:MOST_SHADOWS]
    for n, (row, light, shadow) in enumerate(zip(rows, lights, maps, strict=True)):
        for name in ("place", "towards", "ambient", "diffuse", "specular", "attenuation"):
            row[name] = getattr(light, name)
        row["cutoff"] = -1.0 if light.cutoff >= math.pi else math.cos(light.cutoff)
        row["exponent"], row["directional"] = light.exponent, light.directional
        if n not in alone:
            continue
        number += 1
        row["number"] = number
        if shadow is not None:
            row["frame"], row["version"] = shadow.frame, shadow.version
            row["height"], row["width"] = shadow.texels.shape
            row["shadow"], row["bounds"] = address(shadow.texels) or 0, address(shadow.bounds) or 0
    rest = rest_of(around, len(lights))
    rest["shadow_count"] = number
    return NO_LIGHT._replace(classic=rest, classic_lights=rows)


def rest_of(around: Surroundings, lights: int) -> NDArray[np.void]:
    """(1,) `CLASSIC` without shadows."""
    rest = np.zeros(1, CLASSIC)
    rest["light_count"], rest["sky"] = lights, around.sky
    rest["haze"], rest["ring"], rest["far"] = around.haze, max(around.ring, 1e-6), around.far
    if around.plane is not None:
        rest["hazy"], rest["plane"] = 1, around.plane
    if around.fog is not None:
        rest["foggy"], (rest["fog"], rest["fog_start"], rest["fog_end"]) = 1, around.fog
    return rest


#: light of a white surface that is lit by a light with a diffuse colour of 1
_FULL = math.pi
#: colours of the sky of scenes: horizon, zenith, ground and glow, linear
_SKY = ((0.905, 0.939, 0.965), (0.156, 0.381, 0.730), (0.546, 0.597, 0.645), (1.0, 0.880, 0.672))


def of_scenes(lights: list[Lit], maps: list[ShadowMap | None], around: Surroundings) -> Light:
    """The lamps of scenes: a sun and a spot with shadows, the other lights without, and light of the sky."""
    rows: list[tuple[object, ...]] = []
    light_of_scene = NO_LIGHT
    ambient = np.full(3, 0.12)
    towards = np.array([0.35, -0.45, 0.82])
    for light, shadow in zip(lights, maps, strict=True):
        ambient += light.ambient
        color, here, to = light.diffuse * _FULL, tuple(light.place), tuple(light.towards)
        none = (0.0, 0.0, 0.0)
        if light.directional:
            casts = shadow is not None and light_of_scene.shadow is None
            if shadow is not None and casts:
                light_of_scene = light_of_scene._replace(sun=shadow.frame, shadow=shadow.texels)
                towards = light.towards
            rows.append((SUN, none, to, tuple(color), 0.0, float(casts), 0.0, none))
        elif light.cutoff >= math.pi / 2 - 1e-3:
            rows.append((POINT, here, to, tuple(color), 0.0, 0.0, 0.0, none))
        else:
            casts = shadow is not None and light_of_scene.lamp_shadow is None
            if shadow is not None and casts:
                light_of_scene = light_of_scene._replace(lamp_frame=shadow.frame, lamp_shadow=shadow.texels)
            outer, inner = math.cos(light.cutoff), math.cos(0.6 * light.cutoff)
            rows.append((SPOT, here, to, tuple(color), 0.0, outer, inner, (float(casts), 0.0, 0.0)))
    above = ambient * _FULL
    rows.append((HEMISPHERE, (0, 0, 0), (0, 0, 1), tuple(above), 0.0, 0.0, 0.0, tuple(0.7 * above)))
    mist = (0.0, 0.0) if around.fog is None else (around.fog[1], max(around.fog[2] - around.fog[1], 1e-3))
    sky = np.concatenate([*_SKY, towards, mist, np.zeros(3)]).astype(np.float32)
    return light_of_scene._replace(lamps=np.array(rows, LAMP), sky=sky)
