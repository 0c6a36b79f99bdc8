"""The contents and lamps of a world, from which images are rendered."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.rendering.contents import Contents
from morse.rendering.lit_world import LitWorld
from morse.rendering.painter import Instant, Painter
from morse.scene.water import water_level

if TYPE_CHECKING:
    from collections.abc import Sequence

    from morse.physics import World
    from morse.rendering.contents import MeshStore
    from morse.rendering.orders import Order
    from morse.rendering.picture import Picture
    from morse.rendering.textures import TextureStore


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
