"""Pictures of many states of a model at once: what each of them needs is computed for all of them together.

The numbers are those of `morse.eyes.picture` and `morse.eyes.light`, in the same order of operations: a picture has the
bits of a single one.
"""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from morse.eyes.batch_lights import Maps, classic_lights, lights_of_scenes, without_shadows
from morse.eyes.geoms import PLANE
from morse.eyes.layers import layers_of
from morse.eyes.light import NO_LIGHT, new_version
from morse.eyes.picture import (
    BEYOND,
    NOTHING,
    OPAQUE,
    REFLECTION,
    SHADOW,
    Artist,
    drawer_of,
    from_behind,
    mirrored_box,
    opacity_of,
    seen_of,
    turned_away,
)
from morse.eyes.shadows import MapMaker, casters_of, planes_of
from morse.kernel.drawing.arrays import bounds_shape, bytes_of_cameras
from morse.kernel.drawing.composing import Composition, depths_of, objects_of
from morse.kernel.drawing.worlds import MAP_FROM_AFAR, MAP_FROM_NEAR, Chain, Worlds
from morse.kernel.memory import address

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from morse.eyes.batch_lights import ClassicLights, Lights
    from morse.eyes.picture import View
    from morse.eyes.shadows import Casters
    from morse.kernel.drawing.arrays import Pictures, Poses
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
        lights = lights_of_scenes(scenes.lights)
        if not scenes.flags[SHADOW]:
            lights = without_shadows(lights)
        around = artist.around(instances, g[0], scenes.flags, reach)
        hazy = None if around.plane is None else planes_of(g[:, instances.infinite[0]])
        light = classic_lights(lights, self._shadows(scenes, lights, poses), around, hazy)
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
            dim = classic_lights(without_shadows(lights), {}, NOTHING, None)
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
        if not casting.any() or not lights.casts.any():
            return {}
        views = scenes.views
        seen, makes = seen_of(g[:, ~planes], views), casters_of(g, instances, views)
        maps = {}
        for n in np.flatnonzero(lights.casts):
            place, towards, directional = lights.place[:, n], lights.towards[:, n], bool(lights.directional[n])
            casters = makes(place, towards, directional)
            scale = artist.scale_of_maps(directional=directional)
            cutoff = None if directional else lights.cutoff[:, n]
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
                worlds.set_cameras(cameras[rows])
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
