"""Draws the images of ticks: it needs the meshes of a scene, but not its world."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache
from threading import Lock
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from morse.kernel.drawing.arrays import Light
from morse.kernel.drawing.native import drawer
from morse.rendering.contents import Contents
from morse.rendering.distortion import DistortedLens
from morse.rendering.lights import Shadows, SpotShadows, lamps_of, light_nodes, sky_of
from morse.rendering.picture import Picture
from morse.rendering.requests import cameras_of, cut, kept_of, pixels_of, views_of
from morse.rendering.textures import LIGHT, encoded
from morse.scene.extent import water_level

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from morse.kernel.drawing.arrays import Poses
    from morse.physics import World
    from morse.rendering.contents import MeshStore
    from morse.rendering.lens import Lens, Motion
    from morse.rendering.lights import Lamps
    from morse.rendering.requests import Order
    from morse.rendering.scenery import Frames, Scenery
    from morse.rendering.textures import TextureStore


@lru_cache(maxsize=256)
def cropped(lens: Lens, first: int, last: int) -> Lens:
    """Return the lens of some rows of an image."""
    return replace(lens, height=last - first, cy=lens.cy - first)


def averaged(pictures: Sequence[Picture]) -> Picture:
    """Return the mean light of images; depth, ids and normals are those of the middle one."""
    middle = pictures[len(pictures) // 2]
    if len(pictures) == 1 or middle.rgba is None:
        return middle
    light = np.zeros((*middle.rgba.shape[:2], 3), np.float32)
    for picture in pictures:
        light += LIGHT[picture.rgb]
    rgba = middle.rgba.copy()
    rgba[..., :3] = encoded(light * np.float32(1 / len(pictures)))
    return middle._replace(rgba=rgba)


def joined(bands: Sequence[Picture]) -> Picture:
    """Return the image of its bands of rows."""
    parts: dict[str, Any] = {
        name: None if getattr(bands[0], name) is None else np.concatenate([getattr(band, name) for band in bands])
        for name in ("rgba", "depth", "ids", "normals")
    }
    return bands[-1]._replace(**parts)


#: colour of clear sea water near the surface, linear RGB
_TINT = np.array([0.012, 0.155, 0.2])
#: m: depth at which a quarter of the light is left, and distance at which water hides everything
_DARKER, _SIGHT = 16.0, 26.0


def submerged(sky: NDArray[np.float32], depth: float) -> NDArray[np.float32]:
    """Return the sky (20,) of a camera under water; see `morse.kernel.drawing.arrays.Light`.

    Args:
        sky: above the water.
        depth: of the camera, m.
    """
    under = sky.copy()
    water = _TINT / (1.0 + depth / _DARKER) ** 2
    for begin, share in ((0, 1.0), (3, 2.2), (6, 0.35), (9, 0.0)):  # all around, up, down, around the sun
        under[begin : begin + 3] = water * share
    under[15:17] = 0.0, _SIGHT
    return under


#: maximum number of pixels per call, so that many large cameras do not exhaust the memory
_MOST_PIXELS = 1 << 25


class Instant(NamedTuple):
    """A tick, as far as images show it; later changes of the world do not affect it.

    Attributes:
        frames: the poses of the objects.
        lamps: the lamps; None if no image has colours.
        sky: (20,) float32, see `morse.kernel.drawing.arrays.Light`; None if no image has colours.
        water: height of the surface of the water, m; None without water.
    """

    frames: Frames
    lamps: Lamps | None
    sky: NDArray[np.float32] | None
    water: float | None = None

    def seen_by(self, order: Order) -> Instant:
        """The same tick for one camera, which may be under water."""
        if self.sky is None or self.water is None or not order.color:
            return self
        depth = self.water - float(order.pose(0.0)[0][2])
        return self if depth <= 0.0 else self._replace(sky=submerged(self.sky, depth))


class Painter:
    """Draws images of a scene, in any thread, or, because it can be pickled, in any process: the bits are the same.

    Args:
        samples: number of samples of each pixel.
        lamps, sky: of any tick, see `Instant`.
        before: the painter of the same objects before they were repainted, whose shadow maps this one takes over if
            they are the same; None for another scene.
    """

    def __init__(
        self,
        scenery: Scenery,
        samples: int,
        lamps: NDArray[np.void],
        sky: NDArray[np.float32],
        before: Painter | None = None,
    ) -> None:
        self._scenery, self._samples = scenery, samples
        self._drawer = drawer(scenery.drawing)
        self._light = Light(lamps, sky, np.zeros(16, np.float32), None)
        self._shadows: Shadows | None = None
        if before is not None and before._shadows is None:
            before = before._before  # it has drawn no colours
        self._before: Painter | None = before
        self._spot_shadows = SpotShadows()
        #: the kernel and the shadow maps serve one call at a time
        self._lock = Lock()

    def __reduce__(self) -> tuple[object, ...]:
        return Painter, (self._scenery, self._samples, self._light.lamps, self._light.sky)

    @property
    def drawn_tiles(self) -> int:
        """See `morse.rendering.renderer.Renderer.drawn_tiles`."""
        return self._drawer.drawn_tiles

    def draw(self, instant: Instant, orders: Sequence[Order]) -> list[Picture]:
        """Render the images of a tick, without nodes and names; they do not depend on those rendered before."""
        with self._lock:
            pictures: dict[int, Picture] = {}
            batch: list[int] = []
            pixels = 0
            for number, order in enumerate(orders):
                own_instant = instant.seen_by(order)
                if order.motion is not None:
                    pictures[number] = self._over_time(own_instant, order, order.motion)
                    continue
                if own_instant is not instant:
                    pictures[number] = self._at(own_instant, [order])[0]
                    continue
                own = pixels_of(order)
                if batch and pixels + own > _MOST_PIXELS:
                    pictures.update(zip(batch, self._at(instant, [orders[n] for n in batch]), strict=True))
                    batch, pixels = [], 0
                batch.append(number)
                pixels += own
            if batch:
                pictures.update(zip(batch, self._at(instant, [orders[n] for n in batch]), strict=True))
            return [pictures[number] for number in range(len(orders))]

    def _over_time(self, instant: Instant, order: Order, motion: Motion) -> Picture:
        """Render an image with motion blur or rolling shutter."""
        bands = []
        for number, band in enumerate(motion.bands(order.lens.height)):
            part = order._replace(lens=cropped(order.lens, band.first, band.last), band=number)
            bands.append(averaged([self._at(instant, [part], time)[0] for time in band.times]))
        return joined(bands)

    def _at(self, instant: Instant, orders: Sequence[Order], time: float = 0.0) -> list[Picture]:
        """Render images that show one instant, at a time relative to the tick."""
        poses = self._scenery.poses(instant.frames, time)
        if self._scenery.flexes:
            self._drawer.reshape(self._scenery.flexes[0].clusters.start)
        cameras = cameras_of(orders, time)
        light = self._light
        if cameras["color"].any():
            light = self._lit(instant, poses, cameras)
        images = self._drawer.draw(cameras, poses, light, self._samples, kept_of(orders))
        rows = iter(cameras)
        pictures = []
        for order in orders:
            flats = [cut(images, next(rows)) for _ in views_of(order)]
            whole = order.lens.warp.gather(flats) if isinstance(order.lens, DistortedLens) else flats[0]
            position, rotation = order.pose(time)
            pictures.append(
                Picture(
                    *whole,
                    [],
                    [],
                    poses.models,
                    position.astype(np.float32),
                    rotation.astype(np.float32).T.copy(),
                )
            )
        return pictures

    def _lit(self, instant: Instant, poses: Poses, cameras: NDArray[np.void]) -> Light:
        """The lamps of a tick, with the shadows of the sun and of a spot lamp."""
        lamps, sky = instant.lamps, instant.sky
        assert lamps is not None
        assert sky is not None
        before, self._before = self._before, None
        if before is not None and self._scenery.casts_as(before._scenery):
            with before._lock:  # it may draw an image of an earlier tick
                self._shadows, before._shadows = before._shadows, None
        if self._shadows is None or not np.array_equal(self._shadows.sunny, lamps.sunny):
            self._shadows = Shadows(self._scenery, self._drawer, lamps.sunny, self._light)
        self._shadows.light = self._shadows.light._replace(lamps=lamps.lamps, sky=sky)
        light = self._spot_shadows.update(self._shadows.light, lamps.spot, poses, self._drawer)
        self._shadows.update(poses, cameras)
        return light


# The contents and lamps of a world, from which images are rendered.


class LitWorld:
    """Computes the lamps and the sky again if a lamp or the view has changed."""

    def __init__(self, world: World) -> None:
        self._world, self._nodes = world, light_nodes(world.scene)
        self._key: object = None
        self._now: tuple[Lamps, NDArray[np.float32]] | None = None

    def now(self) -> tuple[Lamps, NDArray[np.float32]]:
        """Return the lamps, and the sky (20,) float32; see `morse.kernel.drawing.arrays.Light`."""
        key = self._present_key()
        if self._now is None or key != self._key:
            lamps = lamps_of(self._nodes, self._world)
            self._key, self._now = key, (lamps, sky_of(self._world.scene.settings, lamps.sunny))
        return self._now

    def _present_key(self) -> list[object]:
        """Everything that lamps and sky depend on."""
        view = self._world.scene.settings.view
        mist = view.mist and (view.mist.enabled, view.mist.start, view.mist.depth)
        key: list[object] = [view.horizon_color, view.ambient_color, view.daylight, view.camera_location, mist]
        for node in self._nodes:
            lamp, obj = node.light, self._world.object_of(node)
            assert lamp is not None
            key.append((lamp.type, lamp.color, lamp.energy, lamp.distance, lamp.spot_size, lamp.casts_shadow))
            key.append((obj.visible, *obj.world_pose()))
        return key


class Stage:
    """The objects, colours and lamps of a world, from which images are rendered until they change.

    `note` reads the world. `draw` does not, and may be called from any thread.

    Args:
        samples: number of samples of each pixel.
        before: the stage before a change of colours, textures or objects.

    Attributes:
        contents: the objects.
        painter: draws them.
    """

    def __init__(
        self, world: World, meshes: MeshStore, textures: TextureStore, samples: int, before: Stage | None = None
    ) -> None:
        self._world = world
        self._arrangement, self._repaints = world.arrangement, world.repaints
        self.contents = Contents(world, meshes, textures)
        self._looks = [(node.color, node.image) for node in self.contents.nodes]
        self._lit_world = LitWorld(world)
        self._water = water_level(world.scene)
        lamps, sky = self._lit_world.now()
        alike = before is not None and before._arrangement == self._arrangement
        painter = before.painter if before is not None and alike else None
        self.painter: Painter = Painter(self.contents.scenery, samples, lamps.lamps, sky, painter)

    def is_current(self) -> bool:
        """Whether no object was added or removed, and no colour or texture has changed."""
        world = self._world
        if self._arrangement != world.arrangement:
            return False
        if self._repaints != world.repaints:
            # changes of visibility are repaints as well
            self._repaints = world.repaints
            return self._looks == [(node.color, node.image) for node in self.contents.nodes]
        return True

    def note(self, orders: Sequence[Order]) -> Instant:
        """Return the present tick, as far as images show it."""
        frames = self.contents.frames(moving=any(order.motion is not None for order in orders))
        if not any(order.color for order in orders):
            return Instant(frames, None, None)
        return Instant(frames, *self._lit_world.now(), self._water)

    def draw(self, instant: Instant, orders: Sequence[Order]) -> list[Picture]:
        """Render the images of a tick; the images do not depend on those rendered before."""
        return [self.named(picture) for picture in self.painter.draw(instant, orders)]

    def named(self, picture: Picture) -> Picture:
        """Return an image of the painter with the nodes and their names."""
        return picture._replace(nodes=self.contents.nodes, names=self.contents.names)
