"""Lights and shadow maps of many states of a model at once.

The numbers are those of `morse.eyes.light`, in the same order of operations.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from morse.eyes.light import DIRECTIONAL, IMAGE, NO_LIGHT, POINT_LIGHT, rest_of
from morse.kernel.drawing.arrays import CLASSIC_LIGHT, MOST_SHADOWS

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from morse.eyes.light import Surroundings
    from morse.kernel.drawing.arrays import Light

    Floats = NDArray[np.float64]
    Flags = NDArray[np.bool_]


class Lights(NamedTuple):
    """The lights of N scenes that are drawn, L; those of MuJoCo that are not finite are left out.

    Attributes:
        rows: (N, L) `CLASSIC_LIGHT` without shadow maps.
        place, towards: (N, L, 3) see `morse.eyes.light.Lit`.
        cutoff: (N, L) rad.
        directional, casts: (L,) the same in all scenes.
    """

    rows: NDArray[np.void]
    place: Floats
    towards: Floats
    cutoff: Floats
    directional: Flags
    casts: Flags


def without_shadows(lights: Lights) -> Lights:
    """The same lights that cast no shadows; see `morse.eyes.light.without_shadows`."""
    return lights._replace(casts=np.zeros_like(lights.casts))


class Maps(NamedTuple):
    """The shadow maps of a light in N scenes; all else of scenes without a map is undefined.

    Attributes:
        has: (N,) whether there is one.
        frame: (N, 16) float32.
        height, width: (N,) texels.
        texels, bounds: (N,) addresses of the texels, and of the bounds of their blocks; 0 without bounds.
        version: (N,) see `morse.eyes.light.ShadowMap`.
        memory: the arrays.
    """

    has: Flags
    frame: NDArray[np.float32]
    height: NDArray[np.intp]
    width: NDArray[np.intp]
    texels: NDArray[np.uint64]
    bounds: NDArray[np.uint64]
    version: NDArray[np.int64]
    memory: tuple[NDArray[np.float32], ...]


def kinds_of_lights(lights: NDArray[np.void]) -> NDArray[np.uint8]:
    """(N, L, 3) whether lights are drawn, are directional, and cast shadows."""
    kind = _types(lights)
    numbers = np.stack([lights[name] for name in _LIGHT_VALUES], axis=-2)
    length = np.sqrt((lights["dir"].astype(np.float64) ** 2).sum(axis=-1))
    drawn = (kind != IMAGE) & np.isfinite(numbers).all(axis=(-1, -2)) & ((length >= 1e-9) | (kind == POINT_LIGHT))
    head = lights["headlight"] != 0
    return np.stack([drawn, head | (kind == DIRECTIONAL), (lights["castshadow"] != 0) & ~head], axis=-1).view(np.uint8)


_LIGHT_VALUES = ("pos", "dir", "ambient", "diffuse", "specular", "attenuation")


def _types(lights: NDArray[np.void]) -> NDArray[np.int32]:
    if "type" in (lights.dtype.names or ()):
        return np.asarray(lights["type"], np.int32)
    return np.where(lights["directional"] != 0, DIRECTIONAL, 0).astype(np.int32)


def lights_of_scenes(lights: NDArray[np.void]) -> Lights:
    """The lights of scenes whose `kinds_of_lights` are the same."""
    drawn, directional, casts = (kinds_of_lights(lights[:1])[0] != 0).T
    own = lights[:, drawn]
    kind = _types(own)
    way = own["dir"].astype(np.float64)
    length = np.sqrt((way**2).sum(axis=-1))
    towards = -way / np.maximum(length, 1e-9)[..., None]
    wide = (kind == POINT_LIGHT) | (own["cutoff"] > 90)
    angles = {value: math.radians(value) for value in set(own["cutoff"].ravel().tolist())}
    cutoff = np.array([angles[value] for value in own["cutoff"].ravel().tolist()]).reshape(kind.shape)
    cutoff = np.where(wide, math.pi, cutoff)
    rows = np.zeros(kind.shape, CLASSIC_LIGHT)
    rows["place"], rows["towards"] = own["pos"], towards
    for name in ("ambient", "diffuse", "specular", "attenuation", "exponent"):
        rows[name] = own[name]
    rows["directional"] = directional[drawn]
    cosines = {value: -1.0 if value >= math.pi else math.cos(value) for value in set(cutoff.ravel().tolist())}
    rows["cutoff"] = np.array([cosines[value] for value in cutoff.ravel().tolist()]).reshape(kind.shape)
    place = own["pos"].astype(np.float64)
    return Lights(rows, place, towards, cutoff, directional[drawn], casts[drawn])


class ClassicLights(NamedTuple):
    """The lights of N scenes, see `Light`.

    Attributes:
        rest: (N,) `CLASSIC`.
        rows: (N, L) `CLASSIC_LIGHT`.
        keys: of each scene: all of it but the shadow maps.
        memory: the shadow maps.
    """

    rest: NDArray[np.void]
    rows: NDArray[np.void]
    keys: list[bytes]
    memory: list[Maps]

    def first(self) -> Light:
        """The lights of the first scene."""
        return NO_LIGHT._replace(classic=self.rest[:1], classic_lights=self.rows[0])


def classic_lights(lights: Lights, maps: dict[int, Maps], around: Surroundings, planes: Floats | None) -> ClassicLights:
    """The lights of scenes; `maps` are those of some lights, `planes` (N, 4) those of the haze."""
    rows, count = lights.rows.copy(), len(lights.rows)
    has = np.zeros(rows.shape, np.bool_)
    for n, own in maps.items():
        has[:, n] = own.has
    # of too many lights that cast shadows, those whose shadows are seen come first
    others = lights.casts & ~has
    rank = np.where(has, has.cumsum(axis=1), has.sum(axis=1, keepdims=True) + others.cumsum(axis=1))
    alone = (has | others) & (rank <= MOST_SHADOWS)
    rows["number"] = np.where(alone, alone.cumsum(axis=1), 0)
    rows["width"] = has & alone
    rest = np.repeat(rest_of(around, len(rows[0])), count)
    rest["shadow_count"] = alone.sum(axis=1)
    if planes is not None:
        rest["plane"] = planes
    keys = [a.tobytes() + b.tobytes() for a, b in zip(rest, rows, strict=True)]
    for n, own in maps.items():
        for name, values in (
            ("frame", own.frame),
            ("version", own.version),
            ("height", own.height),
            ("width", own.width),
            ("shadow", own.texels),
            ("bounds", own.bounds),
        ):
            column, seen = rows[name][:, n], has[:, n] & alone[:, n]
            column[seen] = values[seen]
    return ClassicLights(rest, rows, keys, list(maps.values()))
