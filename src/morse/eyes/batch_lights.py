"""Lights and shadow maps of many states of a model at once.

The numbers are those of `morse.eyes.light`, in the same order of operations.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from morse.eyes.light import (
    BORDER,
    DIRECTIONAL,
    FINER,
    IMAGE,
    NO_LIGHT,
    POINT_LIGHT,
    WIDEST,
    axes_of,
    rest_of,
)
from morse.kernel.drawing.arrays import CAMERA, CLASSIC_LIGHT, MOST_SHADOWS
from morse.mathutils.portable import matmul

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


class Casters(NamedTuple):
    """What casts shadows: spheres around the geoms (N, G), m, and which of them it is.

    Attributes:
        middle: (N, G, 3) float64.
        reach: (N, G, 1) float64.
        casting: (N, G).
        bounded: (N,) whether all of the spheres are known: infinite planes have none.
    """

    middle: Floats
    reach: Floats
    casting: Flags
    bounded: Flags


def _extreme(values: Floats, casting: Flags, *, low: bool) -> Floats:
    """(N, 2) the least or the largest of values (N, G, 2) of what casts shadows."""
    numbers = np.where(casting[..., None], values, math.inf if low else -math.inf)
    return np.asarray(numbers.min(axis=1) if low else numbers.max(axis=1))


class MapMaker:
    """Computes the frames and sizes of shadow maps; see `morse.eyes.light.ShadowMaps`.

    The arguments of its methods are those of N scenes: the `place` (N, 3), m, the direction `towards` (N, 3) and the
    `cutoff` (N,), rad, of a light; the corners `seen` (N, 8, 3) of what the cameras see, m; `scale`: see
    `morse.eyes.light.ShadowMaps.map_of`.

    Args:
        texels: along the side of a map.
        finest: the same of MuJoCo's own.
    """

    def __init__(self, texels: int, finest: int) -> None:
        self._texels, self._finest = texels, finest

    def _texel(self, usual: Floats, side: Floats, whole: Floats | float) -> Floats:
        """(N,) see `morse.eyes.light.ShadowMaps`."""
        most = np.maximum(np.maximum(usual / FINER, side / (self._texels - 2 * BORDER)), whole / self._finest)
        return np.asarray(most)

    def _sizes(self, sides: Floats, fits: Flags) -> NDArray[np.intp]:
        """(N, 2) width and height of maps, texels."""
        counts = np.where(fits[:, None], sides, 0.0).astype(np.intp) + 2 * BORDER + 1
        return np.minimum(counts, self._texels)

    def from_afar(
        self, place: Floats, towards: Floats, seen: Floats, casters: Casters, scale: float
    ) -> tuple[Flags, NDArray[np.float32], NDArray[np.intp]]:
        """Return whether there are maps of a directional light (N,), their frames (N, 16) and sizes (N, 2), texels."""
        axes = _axes(towards)
        places = matmul(seen - place[:, None], axes[:, :2].swapaxes(1, 2))
        low, high = np.maximum(places.min(axis=1), -scale), np.minimum(places.max(axis=1), scale)
        fits = (high > low).all(axis=1)
        texel = (high - low).max(axis=1) / (self._texels - 2 * BORDER)
        middles = matmul(casters.middle - place[:, None], axes[:, :2].swapaxes(1, 2))
        within_low = np.maximum(low, _extreme(middles - casters.reach, casters.casting, low=True))
        within_high = np.minimum(high, _extreme(middles + casters.reach, casters.casting, low=False))
        known = casters.bounded[:, None]
        low, high = np.where(known, within_low, low), np.where(known, within_high, high)
        fits &= (high > low).all(axis=1)
        texel = np.where(casters.bounded, self._texel(texel, (high - low).max(axis=1), 2 * scale), texel)
        frame = np.zeros((len(place), 4, 4))
        frame[:, :3, :3] = axes
        for row in range(2):
            frame[:, row, 3] = BORDER * texel - low[:, row] - (axes[:, row] * place).sum(axis=1)
        frame[:, :2] /= texel[:, None, None]
        # what is behind the light casts no shadow
        frame[:, 3, 0], frame[:, 3, 1], frame[:, 3, 2] = texel, 1.0, (towards * place).sum(axis=1)
        return fits, frame.reshape(-1, 16).astype(np.float32), self._sizes((high - low) / texel[:, None], fits)

    def from_near(
        self, place: Floats, towards: Floats, cutoff: Floats, seen: Floats, casters: Casters, scale: float
    ) -> tuple[Flags, NDArray[np.float32], NDArray[np.void]]:
        """Return whether there are maps of a spot (N,), their frames (N, 16) and their cameras (N,) `CAMERA`."""
        angle = cutoff * scale
        fits = angle <= WIDEST
        tangents = {value: math.tan(value) for value in set(angle.tolist())}
        tangent = np.array([tangents[value] for value in angle.tolist()])
        of_light = _axes(towards)
        axes = np.stack([of_light[:, 0], -of_light[:, 1], -of_light[:, 2]], axis=1)
        places = matmul(seen - place[:, None], axes.swapaxes(1, 2))
        flat = places[..., :2] / places[..., 2:]
        ahead = (places[..., 2] > 1e-3).all(axis=1)[:, None]
        low, high = np.repeat(-tangent[:, None], 2, axis=1), np.repeat(tangent[:, None], 2, axis=1)
        low = np.where(ahead, np.maximum(low, flat.min(axis=1)), low)
        high = np.where(ahead, np.minimum(high, flat.max(axis=1)), high)
        fits &= (high > low).all(axis=1)
        focal = (self._texels - 2 * BORDER) / (high - low).max(axis=1)
        middles, reach = matmul(casters.middle - place[:, None], axes.swapaxes(1, 2)), casters.reach
        near, far = middles[..., 2:] - reach, middles[..., 2:] + reach
        before = (far > 0.0)[..., 0]
        chosen = casters.casting & before
        left, right = middles[..., :2] - reach, middles[..., :2] + reach
        # the nearer end of a sphere is farther from the axis
        left, right = (side / np.where(sign * side > 0.0, near, far) for side, sign in ((left, -1.0), (right, 1.0)))
        clear = (~chosen | (near[..., 0] > 1e-3)).all(axis=1) & casters.bounded
        low = np.where(clear[:, None], np.maximum(low, _extreme(left, chosen, low=True)), low)
        high = np.where(clear[:, None], np.minimum(high, _extreme(right, chosen, low=False)), high)
        fits &= (high > low).all(axis=1)
        focal = np.where(casters.bounded, 1 / self._texel(1 / focal, (high - low).max(axis=1), 2 * tangent), focal)
        sizes = self._sizes((high - low) * focal[:, None], fits)
        cx, cy = (BORDER - low * focal[:, None]).T
        camera = np.zeros(len(place), CAMERA)
        camera["fx"] = camera["fy"] = focal
        camera["cx"], camera["cy"] = cx, cy
        camera["width"], camera["height"] = sizes.T
        camera["near"], camera["far"] = 0.01, 1e4
        camera["axes"], camera["eye"], camera["exposure"] = axes.reshape(-1, 9), place, 1.0
        lens = np.zeros((len(place), 3, 3))
        lens[:, 0, 0], lens[:, 1, 1], lens[:, 2, 2] = focal, focal, 1.0
        lens[:, 0, 2], lens[:, 1, 2] = cx, cy
        matrix = matmul(lens, axes)
        frame = np.zeros((len(place), 16))
        frame[:, :12].reshape(-1, 3, 4)[..., :3] = matrix
        frame[:, 3:12:4] = matmul(-matrix, place[..., None])[..., 0]
        frame[:, 12], frame[:, 13], frame[:, 14] = 1 / focal, cx, cy
        return fits, frame.astype(np.float32), camera


def _axes(towards: Floats) -> Floats:
    """(N, 3, 3) see `morse.eyes.light.axes_of`."""
    known = {row.tobytes(): row for row in towards}
    made = {key: axes_of(row) for key, row in known.items()}
    return np.array([made[row.tobytes()] for row in towards])


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
    numbers = np.zeros(count, np.int32)
    shadows = {}
    for n, own in maps.items():
        shadows[n] = own.has & (numbers < MOST_SHADOWS)
        numbers += shadows[n]
        rows["number"][:, n] = np.where(shadows[n], numbers, 0)
    rest = np.repeat(rest_of(around, len(rows[0])), count)
    rest["shadow_count"] = numbers
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
            column = rows[name][:, n]
            column[shadows[n]] = values[shadows[n]]
    return ClassicLights(rest, rows, keys, list(maps.values()))


def are_below(
    planes: Floats,
    places: NDArray[np.float32],
    which: Flags,
    eyes: Floats,
    light: Floats,
    towards: Floats,
    directional: bool,
) -> Flags:
    """(N,) whether a plane (N, 4) is below a light, the camera and some places: its shadow is not seen."""
    normals, offsets = planes[:, :3], planes[:, 3]
    above = (normals * eyes).sum(axis=1) > offsets
    above &= (((places * normals[:, None]).sum(axis=2) >= offsets[:, None]) | ~which).all(axis=1)
    lit = (towards * normals).sum(axis=1) > 0.0 if directional else (light * normals).sum(axis=1) > offsets
    return np.asarray(above & lit)
