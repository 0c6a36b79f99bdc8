"""The lamps and the sky of a world at its present state."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.rendering.lights import lamps_of, light_nodes, sky_of

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from morse.physics import World
    from morse.rendering.lights import Lamps


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
