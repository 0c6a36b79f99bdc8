"""Contact sensors, whose marker is the contact shape."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.builder.creator import SensorCreator
from morse.scene import NodeKind, PhysicsType

if TYPE_CHECKING:
    from morse.core.classes.builder_defaults import Visual


class ContactSensor(SensorCreator):
    """A sensor that detects contacts with its own body, which does not collide.

    ``scale`` is half the size of that body along each axis, m.
    """

    def _add_marker(self, visual: Visual) -> None:
        node = self.scene_node
        node.kind = NodeKind.MESH
        node.mesh, node.materials = self._marker(visual)
        node.scale[:] = visual.scale
        node.body.type = PhysicsType.SENSOR
