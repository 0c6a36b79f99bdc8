"""Pictures of many states of a model at once: what each of them needs is computed for all of them together.

The numbers are those of `morse.eyes.picture` and `morse.eyes.light`, in the same order of operations: a picture has the
bits of a single one.
"""

from __future__ import annotations

import itertools
import math
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from morse.eyes.geoms import HFIELD, MESH, PLANE
from morse.eyes.light import (
    BORDER,
    DIRECTIONAL,
    FINER,
    IMAGE,
    NO_LIGHT,
    POINT_LIGHT,
    WIDEST,
    axes_of,
    new_version,
    rest_of,
)
from morse.eyes.picture import (
    BEYOND,
    NOTHING,
    OPAQUE,
    REFLECTION,
    SHADOW,
    Artist,
    drawer_of,
    from_behind,
    layers_of,
    mirrored_box,
    opacity_of,
    planes_of,
    reach_of,
    seen_of,
    turned_away,
)
from morse.kernel.drawing.arrays import CAMERA, CLASSIC_LIGHT, MOST_SHADOWS, bounds_shape, bytes_of_cameras
from morse.kernel.drawing.composing import Composition, depths_of, objects_of
from morse.kernel.drawing.worlds import MAP_FROM_AFAR, MAP_FROM_NEAR, Chain, Worlds
from morse.kernel.memory import address
from morse.mathutils.portable import matmul

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from morse.eyes.light import Surroundings
    from morse.eyes.picture import View
    from morse.kernel.drawing.arrays import Light, Pictures, Poses
    from morse.kernel.drawing.composing import Box
    from morse.kernel.drawing.worlds import Memory

    Floats = NDArray[np.float64]
    Flags = NDArray[np.bool_]

#: number of sets of parts that are kept
_MOST_MASKS = 1000


class Scenes(NamedTuple):
    """Scenes with the same instances, N.

    Attributes:
        geoms: (N, G) the geoms.
        lights: (N, L) the lights of MuJoCo.
        views: the cameras.
        chains: (N,) the chain of each of them: scenes of a chain come one after the other.
        flags: of rendering, the same for all.
    """

    geoms: NDArray[np.void]
    lights: NDArray[np.void]
    views: Sequence[View]
    chains: NDArray[np.intp]
    flags: Any

    def take(self, rows: NDArray[np.intp]) -> Scenes:
        """Some of them."""
        views = [self.views[row] for row in rows]
        return Scenes(self.geoms[rows], self.lights[rows], views, self.chains[rows], self.flags)


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


def _lights_of(lights: NDArray[np.void]) -> Lights:
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


class _Field(NamedTuple):
    """The part of shadow maps that is seen: one more number for each of N scenes.

    Attributes:
        axes: (N, 3, 3) right, down and forward of a light; the third row is that towards directional ones.
        low, high: (N, 2) the borders of the part.
        scale: (N,) texels per unit, or the size of a texel.
        fits: (N,) whether there is anything to see.
    """

    axes: Floats
    low: Floats
    high: Floats
    scale: Floats
    fits: Flags


class Casters(NamedTuple):
    """What casts shadows: spheres around the geoms (N, G), m, and which of them it is.

    Attributes:
        middle: (N, G, 3) float64.
        reach: (N, G, 1) float64.
        casting: (N, G).
        bounded: (N,) whether the spheres are known, or infinite planes are among them.
    """

    middle: Floats
    reach: Floats
    casting: Flags
    bounded: Flags


def _around(values: Floats, casting: Flags, least: Flags | None, *, low: bool) -> Floats:
    """(N, 2) the least or the largest of values (N, G, 2) of what casts shadows."""
    chosen = casting if least is None else casting & least
    none = math.inf if low else -math.inf
    numbers = np.where(chosen[..., None], values, none)
    return np.asarray(numbers.min(axis=1) if low else numbers.max(axis=1))


class MapMaker:
    """Where the shadow maps of lights are; see `morse.eyes.light.ShadowMaps`.

    Args:
        texels: along the side of a map.
        finest: the same of MuJoCo's own.
    """

    def __init__(self, texels: int, finest: int) -> None:
        self._texels, self._finest = texels, finest

    def _texel(self, usual: Floats, side: Floats, whole: Floats | float) -> Floats:
        most = np.maximum(np.maximum(usual / FINER, side / (self._texels - 2 * BORDER)), whole / self._finest)
        return np.asarray(most)

    def _sizes(self, sides: Floats, fits: Flags) -> NDArray[np.intp]:
        """(N, 2) width and height of maps, texels."""
        counts = np.where(fits[:, None], sides, 0.0).astype(np.intp) + 2 * BORDER + 1
        return np.minimum(counts, self._texels)

    def from_afar(
        self, place: Floats, towards: Floats, seen: Floats, casters: Casters, scale: float
    ) -> tuple[Flags, NDArray[np.float32], NDArray[np.intp]]:
        """Whether there are maps of a directional light (N,), their frames (N, 16) and their sizes (N, 2)."""
        axes = _axes(towards)
        places = matmul(seen - place[:, None], axes[:, :2].swapaxes(1, 2))
        low, high = np.maximum(places.min(axis=1), -scale), np.minimum(places.max(axis=1), scale)
        fits = (high > low).all(axis=1)
        texel = (high - low).max(axis=1) / (self._texels - 2 * BORDER)
        middles = matmul(casters.middle - place[:, None], axes[:, :2].swapaxes(1, 2))
        within_low = np.maximum(low, _around(middles - casters.reach, casters.casting, None, low=True))
        within_high = np.minimum(high, _around(middles + casters.reach, casters.casting, None, low=False))
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
        """Whether there are maps of a spot (N,), their frames (N, 16) and their cameras (N,)."""
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
        low = np.where(clear[:, None], np.maximum(low, _around(left, chosen, None, low=True)), low)
        high = np.where(clear[:, None], np.minimum(high, _around(right, chosen, None, low=False)), high)
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


class BatchArtist:
    """Draws scenes of one model, many at once; what it keeps only saves time.

    Args:
        artist: of single pictures.
        g: (G,) the geoms of one of them; the instances of all are the same.
        scene: `mujoco.MjvScene` with these geoms.

    Attributes:
        can_draw: whether it draws them: not skins and flexes, whose vertices are those of one scene.
    """

    def __init__(self, artist: Artist, g: NDArray[np.void], scene: Any) -> None:
        self._artist = artist
        self._maker = MapMaker(*artist.texels)
        own = self._instances = artist.instances_of(g, scene)
        self._drawer = drawer_of(own.prepared)
        self._drawer.arrange(own.parts, np.arange(len(own.materials), dtype=np.int32), own.materials, own.maps)
        self._chains: dict[object, Chain] = {}
        self._parts: dict[bytes, NDArray[np.int32]] = {}
        self.can_draw = not self._instances.prepared.moving

    def surfaces(self, scenes: Scenes, kind: str, out: Sequence[NDArray[Any]]) -> None:
        """Draw depths (H, W) or ids (H, W, 2); see `Artist.depths` and `Artist.objects`."""
        first, g, instances = scenes.views[0], scenes.geoms, self._instances
        poses = instances.poses(g, scenes.views, BEYOND * first.far, self._artist.linewidth)
        away = np.array([turned_away(row, view) for row, view in zip(g, scenes.views, strict=True)])
        masks = list(~away[:, instances.geoms][:, instances.owner])
        cameras = np.concatenate([view.row(color=False) for view in scenes.views])
        pictures = self._draw("surfaces", scenes, masks, cameras, poses, None)
        for view, picture, to in zip(scenes.views, pictures, out, strict=True):
            shape = view.height, view.width
            if kind == "depth":
                to[...] = depths_of(picture.depth.reshape(shape), view.far)
            else:
                to[...] = objects_of(picture.ids.reshape(shape), instances.ids)

    def colors(self, scenes: Scenes, out: Sequence[NDArray[np.uint8]]) -> None:
        """Draw the colours (H, W, 3); see `Artist.colors`."""
        with np.errstate(invalid="ignore", over="ignore", divide="ignore"):
            self._colors(scenes, out)

    def _colors(self, scenes: Scenes, out: Sequence[NDArray[np.uint8]]) -> None:
        g, views, instances, artist = scenes.geoms, scenes.views, self._instances, self._artist
        reach = artist.reach(scenes.flags, views[0])
        poses = instances.poses(g, views, reach, artist.linewidth)
        opacity, behind = (
            np.array(each)
            for each in zip(
                *(opacity_of(row, view, instances) for row, view in zip(g, views, strict=True)), strict=True
            )
        )
        clear = opacity < OPAQUE
        solid = list(~clear[:, instances.geoms][:, instances.owner])
        lights = _lights_of(scenes.lights)
        around = artist.around(instances, g[0], scenes.flags, reach)
        hazy = None if around.plane is None else planes_of(g[:, instances.infinite[0]])
        light = _classic(lights, self._shadows(scenes, lights, poses), around, hazy)
        cameras = np.concatenate([view.row(color=True) for view in views])
        firsts = self._draw("picture", scenes, solid, cameras, poses, light)
        layers = [
            layers_of(g[n], np.flatnonzero(clear[n] & (opacity[n] > 0.0)), opacity[n], views[n], artist.linewidth)
            if clear[n].any()
            else []
            for n in range(len(g))
        ]
        pictures = [
            Composition(first, view.width, view.height, exact=bool(own))
            for first, view, own in zip(firsts, views, layers, strict=True)
        ]
        mirrors = (g["reflectance"] > 0) & (g["type"] == PLANE) & ~clear & ~behind
        if scenes.flags[REFLECTION] and mirrors.any():
            dim = _classic(lights, {}, NOTHING, None)
            for number in np.flatnonzero(mirrors.any(axis=0)):
                self._mirror(int(number), scenes, np.flatnonzero(mirrors[:, number]), solid, poses, dim, pictures)
        if any(layers):
            self._layers(scenes, layers, opacity, solid, poses, light, pictures)
        for picture, to in zip(pictures, out, strict=True):
            to[...] = picture.codes()

    def _mirror(
        self,
        number: int,
        scenes: Scenes,
        rows: NDArray[np.intp],
        solid: Sequence[Flags],
        poses: Poses,
        light: ClassicLights,
        pictures: Sequence[Composition],
    ) -> None:
        """Add what a geom mirrors to some of the pictures."""
        instances = self._instances
        chosen = instances.geoms == number
        boxes = {int(row): box for row in rows if (box := pictures[row].extent(chosen)) is not None}
        of = np.array(list(boxes), np.intp)
        if not len(of):
            return
        planes = planes_of(scenes.geoms[of, number])
        views = [scenes.views[row].mirrored(plane) for row, plane in zip(of, planes, strict=True)]
        # a mirror shows neither itself nor planes from behind
        unseen = from_behind(scenes.geoms[of], np.array([view.eye for view in views]))
        unseen[:, number] = True
        masks = np.array([solid[row] for row in of]) & ~unseen[:, instances.geoms][:, instances.owner]
        some: Flags = np.asarray(masks.any(axis=1))
        of, masks = of[some], masks[some]
        views = [view for view, any_ in zip(views, some.tolist(), strict=True) if any_]
        if not len(of):
            return
        cut = [view.cut(mirrored_box(boxes[int(row)], scenes.views[row])) for row, view in zip(of, views, strict=True)]
        cameras = np.concatenate([view.row(color=True) for view in cut])
        images = self._draw(("mirror", number), scenes, list(masks), cameras, poses, light, of)
        for row, image in zip(of, images, strict=True):
            share = float(scenes.geoms["reflectance"][row, number])
            pictures[row].reflect(image, boxes[int(row)], chosen, share)

    def _layers(
        self,
        scenes: Scenes,
        layers: Sequence[list[tuple[list[int], Box]]],
        opacity: NDArray[np.float32],
        solid: Sequence[Flags],
        poses: Poses,
        light: ClassicLights,
        pictures: Sequence[Composition],
    ) -> None:
        """Draw the translucent geoms over the pictures, the farthest first."""
        instances = self._instances
        each = [(row, numbers, box) for row, own in enumerate(layers) for numbers, box in own]
        chosen = [np.isin(instances.geoms, numbers) for _, numbers, _ in each]
        masks = [(own[instances.owner], solid[row]) for own, (row, _, _) in zip(chosen, each, strict=True)]
        cameras = np.concatenate([scenes.views[row].cut(box).row(color=True) for row, _, box in each])
        images = self._draw(None, scenes, masks, cameras, poses, light, np.array([row for row, _, _ in each]))
        for (row, numbers, box), own, image in zip(each, chosen, images, strict=True):
            # MuJoCo draws translucent surfaces twice
            pictures[row].cover(image, box, own, 1 - (1 - float(opacity[row, numbers[0]])) ** 2)

    def _parts_of(self, mask: Flags | tuple[Flags, ...]) -> NDArray[np.int32]:
        """The parts that are drawn: those of a mask, or those of several masks one after the other."""
        masks = mask if isinstance(mask, tuple) else (mask,)
        key = b"".join([one.tobytes() for one in masks])
        parts = self._parts.get(key)
        if parts is None:
            if len(self._parts) >= _MOST_MASKS:
                self._parts.clear()
            parts = np.concatenate([self._instances.parts[one] for one in masks])
            self._parts[key] = parts
        return parts

    def _draw(
        self,
        name: object,
        scenes: Scenes,
        masks: Sequence[Flags | tuple[Flags, ...]],
        cameras: NDArray[np.void],
        poses: Poses,
        light: ClassicLights | None,
        of: NDArray[np.intp] | None = None,
    ) -> list[Pictures]:
        """Draw pictures.

        Args:
            name: of the purpose for which the last pictures are kept, None for none.
            masks: (K,) see `_parts_of`.
            cameras: (K,) `CAMERA`.
            of: (K,) the scene of each of them, in rising order; None for all scenes.
        """
        states = np.arange(len(scenes.views)) if of is None else of
        first = NO_LIGHT if light is None else light.first()
        worlds = Worlds(self._drawer, len(cameras), first, 1 if light is None else 5)
        worlds.set_parts([self._parts_of(mask) for mask in masks])
        worlds.set_cameras(cameras)
        self._place(worlds, poses, states, len(scenes.views))
        if light is not None:
            worlds.set(of=states, classic=light.rest, classic_lights=light.rows)
        pictures = worlds.set_pictures(cameras, color=light is not None)
        chains = scenes.chains[states]
        firsts = np.flatnonzero(np.append(True, chains[1:] != chains[:-1]))
        ends = np.append(firsts, len(cameras))
        try:
            if name is not None:
                keys = self._keys(masks, cameras, light, states)
                memories: list[Memory | None] = []
                for begin, end in itertools.pairwise(ends):
                    chain = self._chains.setdefault((name, int(chains[begin])), Chain(self._drawer))
                    lights = None if light is None else light.rows
                    memories += chain.follow(keys[begin:end], cameras[begin:end], len(self._instances.scales), lights)
                worlds.set_memories(memories)
            worlds.draw(ends)
        except BaseException:
            # it is not known which of them are complete
            self._chains.clear()
            raise
        return pictures

    def _keys(
        self,
        masks: Sequence[Flags | tuple[Flags, ...]],
        cameras: NDArray[np.void],
        light: ClassicLights | None,
        states: NDArray[np.intp],
    ) -> list[object]:
        """All that pictures depend on besides poses and shadow maps."""
        maps = self._instances.maps.tobytes()
        of_cameras = bytes_of_cameras(cameras)
        of_lights = [b""] * len(masks) if light is None else [light.keys[state] for state in states]
        return [
            (maps, np.asarray(mask).tobytes(), of_cameras[n].tobytes(), own)
            for n, (mask, own) in enumerate(zip(masks, of_lights, strict=True))
        ]

    def _place(self, worlds: Worlds, poses: Poses, states: NDArray[np.intp], count: int) -> None:
        """Set the poses of the instances of some of N states."""
        worlds.set(of=states, models=poses.models.reshape(count, -1), turns=poses.turns.reshape(count, -1))

    def _shadows(self, scenes: Scenes, lights: Lights, poses: Poses) -> dict[int, Maps]:
        """The shadow maps of lights, by their numbers."""
        g, instances, artist = scenes.geoms, self._instances, self._artist
        casting, planes = instances.casting, instances.planes
        if not scenes.flags[SHADOW] or not casting.any() or not lights.casts.any():
            return {}
        views = scenes.views
        seen = seen_of(g[:, ~planes], views)
        finite = np.isfinite(g["pos"]).all(axis=2)
        reach: Floats = np.asarray(reach_of(g) * np.where(np.isin(g["type"], (MESH, HFIELD)), 2.0, 1.0), np.float64)
        middle = g["pos"].astype(np.float64)
        eyes = np.array([view.eye for view in views])
        flat = {int(plane): planes_of(g[:, plane]) for plane in np.flatnonzero(casting & planes)}
        maps = {}
        for n in np.flatnonzero(lights.casts):
            place, towards = lights.place[:, n], lights.towards[:, n]
            cast = np.repeat(casting[None], len(g), axis=0)
            for plane, own in flat.items():
                others = g["pos"]
                below = _are_below(own, others, ~planes & finite, eyes, place, towards, bool(lights.directional[n]))
                cast[:, plane] = ~below
            cast &= finite
            casters = Casters(middle, reach[..., None], cast, np.asarray(~cast[:, instances.infinite].any(axis=1)))
            scale = artist.scale_of_maps(directional=bool(lights.directional[n]))
            cutoff = None if lights.directional[n] else lights.cutoff[:, n]
            maps[int(n)] = self._map(place, towards, cutoff, seen, casters, scale, poses)
        return maps

    def _map(
        self,
        place: Floats,
        towards: Floats,
        cutoff: Floats | None,
        seen: Floats,
        casters: Casters,
        scale: float,
        poses: Poses,
    ) -> Maps:
        """The maps of a light."""
        maker, count = self._maker, len(place)
        if cutoff is None:
            has, frame, sizes = maker.from_afar(place, towards, seen, casters, scale)
            width, height = sizes.T
        else:
            has, frame, cameras = maker.from_near(place, towards, cutoff, seen, casters, scale)
            width, height = cameras["width"].astype(np.intp), cameras["height"].astype(np.intp)
        models = poses.models.reshape(count, -1)
        depends: list[NDArray[Any]] = [place, towards, seen.reshape(count, -1), models, casters.casting, frame]
        same = np.all([(one[1:] == one[:-1]).all(axis=1) for one in depends], axis=0)
        drawn = has & np.append(True, ~same)
        # scenes whose maps are those of the scene before
        source = np.maximum.accumulate(np.where(drawn, np.arange(count), 0))
        rows = np.flatnonzero(drawn)
        texels = np.empty(int((width * height)[rows].sum()) + 1, np.float32)
        starts = np.zeros(count, np.int64)
        starts[rows] = np.cumsum((width * height)[rows]) - (width * height)[rows]
        at = (address(texels) or 0) + 4 * starts
        shapes = [bounds_shape(int(h), int(w)) for h, w in zip(height[rows], width[rows], strict=True)]
        blocks = np.array([0 if shape is None else shape[0] * shape[1] for shape in shapes], np.int64)
        bounds = np.empty((int(blocks.sum()) + 1, 4), np.float32)
        of_bounds = np.zeros(count, np.int64)
        of_bounds[rows] = np.where(blocks > 0, (address(bounds) or 0) + 16 * (np.cumsum(blocks) - blocks), 0)
        if len(rows):
            worlds = Worlds(self._drawer, len(rows), NO_LIGHT, 1)
            worlds.set_parts(
                [self._parts_of(casters.casting[row][self._instances.geoms][self._instances.owner]) for row in rows]
            )
            self._place(worlds, poses, rows, count)
            if cutoff is None:
                worlds.set(of=rows, sun=frame)
                worlds.set_maps(at[rows], width[rows], height[rows])
            else:
                own = cameras[rows]
                worlds.set_cameras(own)
                worlds.set_depths(at[rows])
            worlds.rows["kind"], worlds.rows["bounds"] = (
                MAP_FROM_AFAR if cutoff is None else MAP_FROM_NEAR,
                of_bounds[rows],
            )
            worlds.draw(np.arange(len(rows) + 1))
        versions = np.zeros(count, np.int64)
        versions[rows] = [new_version() for _ in rows]
        return Maps(
            has,
            frame[source],
            height[source],
            width[source],
            at[source].astype(np.uint64),
            of_bounds[source].astype(np.uint64),
            versions[source],
            (texels, bounds),
        )


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


def _classic(lights: Lights, maps: dict[int, Maps], around: Surroundings, planes: Floats | None) -> ClassicLights:
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


def _are_below(
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
