"""The colour, the texture and the lamp of an object, which may change while the simulation runs."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from morse.scene import shared_image

if TYPE_CHECKING:
    from morse.core.values import StateData
    from morse.physics.state.saved import SavedObject
    from morse.scene import Node

#: what may change of a lamp
_LAMP = ("color", "energy", "distance", "spot_size")


class Looks:
    """The looks that a node has in the scene."""

    def __init__(self, node: Node) -> None:
        self._node = node
        self._start = node.color, node.light, node.image

    def restore(self) -> bool:
        """Restore the looks of the scene; return whether they had changed."""
        node = self._node
        if (node.color, node.light, node.image) == self._start:
            return False
        node.color, node.light, node.image = self._start
        return True

    def get_state(self) -> StateData:
        """Return the lamp, and a colour that differs from the scene; see `morse.physics.state.saved.SavedObject`."""
        node = self._node
        state: StateData = {}
        if node.color != self._start[0] and node.color is not None:
            state["color"] = tuple(map(float, node.color))
        if node.image is not None and node.image is not self._start[2]:
            state["texture"] = {"name": node.image.name, "mime": node.image.mime, "data": node.image.data}
        # the whole lamp, because an actuator may have set it before the first tick, and in the scene
        if node.light is not None:
            state["lamp"] = {name: getattr(node.light, name) for name in _LAMP}
        return state

    def set_state(self, state: SavedObject) -> bool:
        """Restore a validated state of an object that has the looks of the scene; return whether it differs."""
        node = self._node
        before = node.color, node.light, node.image
        if state.color is not None:
            node.color = state.color
        if state.lamp is not None and node.light is not None:
            node.light = replace(node.light, **{name: getattr(state.lamp, name) for name in _LAMP})
        if state.texture is not None:
            node.image = shared_image(state.texture.name, state.texture.data, state.texture.mime)
        return (node.color, node.light, node.image) != before
