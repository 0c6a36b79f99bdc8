"""Where shadow maps are, and what casts shadows into them: of a light in N scenes at once."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from morse.eyes.geoms import HFIELD, MESH
from morse.eyes.layers import reach_of
from morse.kernel.drawing.arrays import CAMERA
from morse.mathutils.portable import matmul
from morse.mathutils.rotations import cross

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray

    from morse.eyes.geoms import Instances
    from morse.eyes.picture import View

    Floats = NDArray[np.float64]
    Flags = NDArray[np.bool_]

#: widest half angle of the shadow map of a light, rad
WIDEST = 1.4
#: how much finer maps around what casts shadows may be
FINER = 2.0
#: texels at the border of a map
BORDER = 4


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


def axes_of(towards: NDArray[np.float64]) -> NDArray[np.float64]:
    """(3, 3) rows: two directions perpendicular to the light, and that towards it."""
    back = towards.tolist()
    right = cross(back, (0.0, 1.0, 0.0) if abs(back[1]) < 0.9 else (1.0, 0.0, 0.0))
    length = math.sqrt(sum(part * part for part in right))
    right = right[0] / length, right[1] / length, right[2] / length
    return np.array([right, cross(back, right), back])


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


def casters_of(
    g: NDArray[np.void], instances: Instances, views: Sequence[View]
) -> Callable[[NDArray[np.float64], NDArray[np.float64], bool], Casters]:
    """Return a function that returns what casts shadows of a light in N scenes of geoms (N, G).

    Its arguments are the places (N, 3) of the light, m, the unit vectors (N, 3) against its direction, and whether it
    is directional.
    """
    planes, finite = instances.planes, np.isfinite(g["pos"]).all(axis=2)
    larger = np.where(np.isin(g["type"], (MESH, HFIELD)), 2.0, 1.0)
    reach = np.asarray(reach_of(g) * larger, np.float64)[..., None]
    middle = g["pos"].astype(np.float64)
    eyes = np.array([view.eye for view in views])
    flat = {int(plane): planes_of(g[:, plane]) for plane in np.flatnonzero(instances.casting & planes)}

    def make(place: NDArray[np.float64], towards: NDArray[np.float64], directional: bool) -> Casters:
        casting = np.repeat(instances.casting[None], len(g), axis=0)
        for plane, own in flat.items():
            casting[:, plane] = ~are_below(own, g["pos"], ~planes & finite, eyes, place, towards, directional)
        casting &= finite
        # the vertices of skins and flexes are elsewhere
        bounded = ~casting[:, instances.infinite].any(axis=1) & (len(instances.free) == 0)
        return Casters(middle, reach, casting, np.asarray(bounded))

    return make


def planes_of(g: NDArray[np.void]) -> NDArray[np.float64]:
    """(N, 4) the normals and the offsets of planes."""
    normals = g["mat"].reshape(-1, 3, 3)[:, :, 2].astype(np.float64)
    return np.asarray(np.column_stack([normals, (normals * g["pos"]).sum(axis=1)]), np.float64)
