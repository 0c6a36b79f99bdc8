"""The contents and lamps of a world, from which images are rendered."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.rendering.contents import Contents
from morse.rendering.lights import lamps_of, light_nodes, sky_of
from morse.rendering.painter import Instant, Painter
from morse.scene.water import water_level

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy as np
    from numpy.typing import NDArray

    from morse.physics import World
    from morse.rendering.contents import MeshStore
    from morse.rendering.lights import Lamps
    from morse.rendering.orders import Order
    from morse.rendering.picture import Picture
    from morse.rendering.textures import TextureStore


class LitWorld:
    """Computes the lamps and the sky again if a lamp or the view has changed."""

    def __init__(self, world: World) -> None:
        self._world, self._nodes = world, light_nodes(world.scene)
        self._key: object = None
        self._now: tuple[Lamps, NDArray[np.float32]] | None = None

    def now(self) -> tuple[Lamps, NDArray[np.float32]]:
        """Return the lamps, and the sky (20,) float32; see `morse.kernel.drawing.Light`."""
        key = self._present_key()
        if self._now is None or key != self._key:
            lamps = lamps_of(self._nodes, self._world)
            self._key, self._now = key, (lamps, sky_of(self._world.scene.settings.view, lamps.sunny))
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
